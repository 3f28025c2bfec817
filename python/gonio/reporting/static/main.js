"use strict";
// State of the controls, and what follows from a change.
Gonio.state = { incidence: 0, channel: 0, quantity: "dsf", log: true, common: true, readings: false, zoom: "all" };

Gonio.show = () => {
  const state = Gonio.state, i = Gonio.data.incidences[state.incidence];
  if (!i) return;
  const several = Gonio.azimuths().length > 1;
  const text = "θi " + Gonio.angle(i.theta_i) + (several ? ", φi " + Gonio.angle(i.phi_i) : "");
  document.getElementById("incidence-text").textContent = text;
  const slider = document.getElementById("incidence");
  slider.value = state.incidence;
  slider.setAttribute("aria-valuetext", text);
  document.querySelectorAll(".card").forEach((card) => card.setAttribute("aria-pressed", String(Number(card.dataset.incidence) === state.incidence)));
  const s = Gonio.find(state.incidence, state.channel);
  document.querySelectorAll("#lobes figure").forEach((figure) => { figure.hidden = !s; });
  Gonio.showFacts(s);
  if (!s) return;
  Gonio.drawProfile(s, state);
  Gonio.drawMap(s, state);
  const turn = Gonio.turn = (Gonio.turn || 0) + 1;
  requestAnimationFrame(() => setTimeout(() => { if (turn === Gonio.turn) Gonio.showLobe(s, { ...state }); }, 0));
};

// The lobe follows when the flat figures are on the screen: it takes the longest, above all without a graphics card.
Gonio.showLobe = (s, state) => {
  const lobe = Gonio.drawLobe(s, state);
  if (lobe) Gonio.keepForPrint(lobe);
};

Gonio.showFacts = (s) => {
  const list = document.getElementById("slice-facts");
  list.replaceChildren();
  const facts = s ? Gonio.facts[s.index] : [["This incidence", "has no slice of this channel"]];
  for (const [label, value] of facts) {
    const row = document.createElement("div"), dt = document.createElement("dt"), dd = document.createElement("dd");
    dt.textContent = label; dd.textContent = value;
    row.append(dt, dd);
    list.append(row);
  }
};

// A WebGL canvas prints empty in some browsers: keep a picture of the lobe for paper.
Gonio.keepForPrint = (element) => {
  clearTimeout(Gonio.printTimer);
  Gonio.printTimer = setTimeout(() => {
    Plotly.toImage(element, { format: "png", width: 620, height: 560, scale: 1.5 }).then((url) => {
      document.getElementById("lobe-print").src = url;
      element.closest("figure").classList.add("has-print");
    }).catch(() => {});
  }, 700);
};

Gonio.listen = () => {
  const on = (id, event, change) => {
    const element = document.getElementById(id);
    if (element) element.addEventListener(event, () => { change(element); Gonio.later(); });
  };
  on("incidence", "input", (e) => { Gonio.state.incidence = Number(e.value); });
  on("channel", "change", (e) => { Gonio.state.channel = Number(e.value); });
  on("quantity", "change", (e) => { Gonio.state.quantity = e.value; });
  on("scale", "change", (e) => { Gonio.state.log = e.value === "log"; });
  on("common", "change", (e) => { Gonio.state.common = e.checked; });
  on("readings", "change", (e) => { Gonio.state.readings = e.checked; });
  document.querySelectorAll(".card").forEach((card) => card.addEventListener("click", () => { Gonio.state.incidence = Number(card.dataset.incidence); Gonio.later(); }));
  document.querySelectorAll("[data-range]").forEach((button) => button.addEventListener("click", () => { Gonio.state.zoom = button.dataset.range; Gonio.later(); }));
  addEventListener("beforeprint", () => document.querySelectorAll("details").forEach((d) => { d.open = true; }));
  matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => { Gonio.drawIntegrals(); Gonio.later(); });
};

// Draw once a frame however fast the slider moves.
Gonio.later = () => {
  if (Gonio.pending) return;
  Gonio.pending = true;
  requestAnimationFrame(() => { Gonio.pending = false; Gonio.show(); });
};

Gonio.start = () => {
  const n = Gonio.data.incidences.length;
  Gonio.state.incidence = Math.max(0, Math.min(n - 1, Gonio.data.incidences.findIndex((i) => i.theta_i >= 29)));
  Gonio.listen();
  Gonio.drawIntegrals();
  Gonio.later();
};
Gonio.start();
