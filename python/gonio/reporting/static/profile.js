"use strict";
// The profile in the plane of incidence over the extended polar angle.
Gonio.extended = (theta, phi, plane) => {
  const [x, y, z] = Gonio.vector(theta, phi), f = plane * Math.PI / 180;
  const angle = Math.atan2(x * Math.cos(f) + y * Math.sin(f), z) * 180 / Math.PI;
  return angle < -90.0001 ? angle + 360 : angle;
};

// Closed outlines of the band between two curves, one a run, with breaks between.
Gonio.band = (x, low, high) => {
  const bx = [], by = [];
  let start = -1;
  const close = (stop) => {
    for (let k = start; k < stop; k += 1) { bx.push(x[k]); by.push(high[k]); }
    for (let k = stop - 1; k >= start; k -= 1) { bx.push(x[k]); by.push(low[k]); }
    bx.push(x[start], null); by.push(high[start], null);
    start = -1;
  };
  for (let k = 0; k <= x.length; k += 1) {
    const good = k < x.length && Number.isFinite(x[k]) && Number.isFinite(low[k]) && Number.isFinite(high[k]);
    if (good && start < 0) start = k;
    if (!good && start >= 0) close(k);
  }
  return { x: bx, y: by };
};

Gonio.drawProfile = (s, state) => {
  const p = Gonio.palette(), log = state.log, profile = s.profile, range = Gonio.range(state);
  const bsdf = state.quantity === "bsdf", unit = Gonio.label(state) + " [1/sr]";
  const per = (x) => (bsdf ? Math.max(Math.abs(Math.cos(x * Math.PI / 180)), 0.0175) : 1);
  const bottom = log ? Gonio.profileBottom(s, range) : 0;
  const take = (x, y) => Array.from(y, (v, k) => v / per(x[k]));
  const y = take(profile.x, profile.y), u = take(profile.x, profile.u), x = Array.from(profile.x);
  const clip = (v) => (log ? Math.max(v, bottom) : v);
  const shape = Gonio.band(x, y.map((v, k) => (u[k] > 0 ? clip(v - 2 * u[k]) : NaN)), y.map((v, k) => (u[k] > 0 ? clip(v + 2 * u[k]) : NaN)));
  const gap = (v) => (log && !(v > 0) ? null : v);
  const traces = [
    { type: "scatter", mode: "lines", name: "95 % band (k = 2)", x: shape.x, y: shape.y, fill: "toself", fillcolor: p.band, line: { width: 0 }, hoverinfo: "skip" },
    { type: "scatter", mode: "lines", name: profile.interpolated ? "section through the readings" : "readings joined", x, y: y.map(gap), line: { color: p.data, width: 1.8 }, hoverinfo: "skip", connectgaps: false },
  ];
  const styles = { truth: { color: p.truth, dash: "dash", width: 1.4 }, model: { color: p.model, dash: "dashdot", width: 1.8 } };
  for (const r of Gonio.data.references) {
    const reference = take(profile.x, profile.references[r.name]).map(gap);
    traces.push({ type: "scatter", mode: "lines", name: r.label, x, y: reference, line: styles[r.name], hovertemplate: "%{y:.4g} 1/sr<extra>" + r.label + " at %{x:.2f}°</extra>" });
  }
  traces.push(...Gonio.profileMarks(profile.marks, per, log, bottom, p));
  if (s.floor) {
    const all = [], floor = [];
    for (let a = -89.5; a <= 269.5; a += 0.5) { all.push(a); floor.push(Math.abs(Math.abs(a - 90) - 0) < 0.3 ? null : s.floor / per(a)); }
    traces.push({ type: "scatter", mode: "lines", name: "noise floor", x: all, y: floor, line: { color: p.quiet, width: 1, dash: "dot" }, hovertemplate: "noise floor " + Gonio.number(s.floor, 2) + " 1/sr (DSF)<extra></extra>" });
  }
  const two = Gonio.data.sides.length > 1, span = two ? [-90, 270] : Gonio.data.sides[0] === "back" ? [90, 270] : [-90, 90];
  const marks = Gonio.profileLandmarks(s, span, p);
  const top = range.positive ? range.high : null;
  const yaxis = log
    ? Object.assign({ type: "log", range: [Math.log10(bottom), Math.log10((top || 1) * 1.9)], minor: { dtick: "D1", ticklen: 2, ticks: "outside" } }, Gonio.logTicks(bottom, (top || 1) * 1.9))
    : { type: "linear", range: Gonio.profileLinearRange(profile, per, top), exponentformat: "power", zeroline: true, zerolinecolor: p.line };
  const residuals = Gonio.residuals(s, p);
  traces.push(...residuals.traces);
  const zoom = Gonio.zooms[state.zoom](s, span);
  document.getElementById("plot-profile").style.height = residuals.traces.length ? "540px" : "";
  Plotly.react("plot-profile", traces, Gonio.layout(p, {
    ...residuals.layout,
    shapes: marks.shapes, annotations: marks.annotations, hovermode: "closest", legend: { orientation: "h", x: 0, y: -0.2, yanchor: "top" }, margin: { l: 76, r: 16, t: 44, b: 96 },
    xaxis: Gonio.axis(p, "Extended polar angle θ<sub>s</sub> in the plane φ = " + Gonio.angle(profile.phi) + " [deg]", { range: zoom, dtick: zoom[1] - zoom[0] > 100 ? 30 : 5, anchor: residuals.traces.length ? "y2" : "y" }),
    yaxis: Gonio.axis(p, unit, Object.assign(yaxis, residuals.traces.length ? { domain: [.32, 1] } : {})),
  }), Gonio.CONFIG);
  document.getElementById("profile-caption").textContent = Gonio.profileCaption(s, log);
};

// The section against each reference in percent, with the readings' own 95 % band, in a panel of its own.
Gonio.residuals = (s, p) => {
  if (!Gonio.data.references.length) return { traces: [], layout: {} };
  const profile = s.profile, x = Array.from(profile.x), floor = s.floor || 0, traces = [], seen = [];
  const first = profile.references[Gonio.data.references[0].name];
  const band = x.map((_, k) => (first[k] > floor && profile.u[k] > 0 ? 200 * profile.u[k] / first[k] : NaN));
  const shape = Gonio.band(x, band.map((v) => -v), band);
  traces.push({ type: "scatter", mode: "lines", x: shape.x, y: shape.y, yaxis: "y2", fill: "toself", fillcolor: p.band, line: { width: 0 }, hoverinfo: "skip", showlegend: false });
  for (const r of Gonio.data.references) {
    const y = x.map((_, k) => { const e = profile.references[r.name][k]; return e > floor && e > 0 ? 100 * (profile.y[k] / e - 1) : null; });
    seen.push(...y.filter((v) => v !== null && Number.isFinite(v)).map(Math.abs));
    traces.push({ type: "scatter", mode: "lines", x, y, yaxis: "y2", line: { color: r.name === "truth" ? p.truth : p.model, width: 1.3 }, name: "difference", showlegend: false, hovertemplate: "%{y:.2f} %<extra>readings − " + r.label + "</extra>" });
  }
  seen.sort((a, b) => a - b);
  const most = Math.max(2, 1.4 * (seen[Math.floor(seen.length * .97)] || 0));
  return { traces, layout: { yaxis2: Gonio.axis(p, "difference [%]", { domain: [0, .22], range: [-most, most], nticks: 5, zeroline: true, zerolinecolor: p.quiet }) } };
};

// Every decade of a logarithmic axis as a power of ten.
Gonio.logTicks = (low, high) => {
  const ticks = Gonio.decadeTicks(Math.log10(low), Math.log10(high));
  return { tickvals: ticks.values.map((e) => 10 ** e), ticktext: ticks.labels };
};

Gonio.zooms = {
  all: (s, span) => span,
  mirror: (s, span) => [Math.max(s.theta_i - 15, span[0]), Math.min(s.theta_i + 15, span[1])],
  through: (s, span) => [Math.max(180 - s.theta_i - 15, span[0]), Math.min(180 - s.theta_i + 15, span[1])],
};

// Lower end of a logarithmic axis: under the noise floor when that is near the weakest values, else under those.
Gonio.profileBottom = (s, range) => {
  const least = s.floor && s.floor > range.low / 30 ? Math.min(s.floor, range.low) : range.low;
  return range.positive ? Math.max(least / 4, range.high * 1e-7) : 1e-6;
};

Gonio.profileLinearRange = (profile, per, top) => {
  let low = 0, high = top || 0;
  for (let k = 0; k < profile.marks.y.length; k += 1) {
    const v = profile.marks.y[k] / per(profile.marks.x[k]);
    if (v < low) low = v;
    if (!top && v > high) high = v;
  }
  const span = (high - low) || 1;
  return [low - 0.04 * span, high + 0.1 * span];
};

// Readings near the plane; those that a logarithmic axis cannot show stand at its lower edge.
Gonio.profileMarks = (marks, per, log, bottom, p) => {
  const sets = { plain: [[], [], []], noise: [[], [], []], negative: [[], [], []] };
  for (let k = 0; k < marks.x.length; k += 1) {
    const v = marks.y[k] / per(marks.x[k]), u = marks.u[k] / per(marks.x[k]);
    const set = v < 0 ? sets.negative : marks.noise[k] ? sets.noise : sets.plain;
    set[0].push(marks.x[k]); set[1].push(log ? Math.max(v, bottom * 1.12) : v); set[2].push(Gonio.withUncertainty(v, u) + " 1/sr");
  }
  const make = (set, name, marker) => ({ type: "scatter", mode: "markers", name, x: set[0], y: set[1], text: set[2], marker, hovertemplate: "%{text}<extra>" + name + " at %{x:.2f}°</extra>" });
  return [
    make(sets.plain, "reading", { color: p.mark, size: 3.5 }),
    make(sets.noise, "reading below noise", { color: p.ground, size: 5, line: { color: p.mark, width: 1 } }),
    make(sets.negative, log ? "negative reading (at the lower edge)" : "negative reading", { color: p.negative, size: 7, symbol: "triangle-down" }),
  ].filter((t) => t.x.length);
};

Gonio.profileLandmarks = (s, span, p) => {
  const shapes = [], annotations = [], plane = s.profile.phi, rear = s.theta_i > 90, seen = [];
  const note = (x, y, text, extra) => annotations.push(Object.assign({ x, y, yref: "paper", text, showarrow: false, yanchor: "bottom", font: { size: 11.5, color: p.quiet } }, extra));
  for (const m of Gonio.landmarks(s)) {
    const x = Gonio.extended(m.theta, m.phi, plane);
    if (x < span[0] || x > span[1]) continue;
    shapes.push({ type: "line", x0: x, x1: x, yref: "paper", y0: 0, y1: 1, line: { color: p.quiet, width: 1, dash: m.dash === "solid" ? "solid" : m.dash }, layer: "below" });
    const near = seen.find((o) => Math.abs(o.x - x) < 0.5);
    if (near) near.annotation.text += " = " + m.name;
    else { note(x, 1.0, m.name); seen.push({ x, annotation: annotations[annotations.length - 1] }); }
    if (Gonio.data.fwhm && m.name !== "incidence") shapes.push({ type: "rect", x0: x - Gonio.data.fwhm / 2, x1: x + Gonio.data.fwhm / 2, yref: "paper", y0: 0, y1: 1, line: { width: 0 }, fillcolor: p.quiet, opacity: .18, layer: "below" });
  }
  if (span[0] < 0) note(0, 1.06, "<b>" + (rear ? "transmission" : "reflection") + " · front</b>");
  if (span[1] > 180) note(180, 1.06, "<b>" + (rear ? "reflection" : "transmission") + " · back</b>");
  if (span[0] < 90 && span[1] > 90) shapes.push({ type: "line", x0: 90, x1: 90, yref: "paper", y0: 0, y1: 1, line: { color: p.ink, width: 1 }, layer: "below" });
  return { shapes, annotations };
};

Gonio.profileCaption = (s, log) => {
  const parts = ["Dots: readings within " + String(s.profile.tolerance) + "° of the plane."];
  parts.push(s.profile.interpolated ? "Line: neighbouring readings joined across the plane; a gap where there was no neighbour." : "These readings lie in one plane and are joined directly; a gap where a step is missing.");
  if (Gonio.data.fwhm) parts.push("Resolution: the beam is " + Gonio.number(Gonio.data.fwhm, 3) + "° wide (FWHM, grey stripe); nothing narrower can be seen.");
  if (log && s.floor) parts.push("Below the noise floor (DSF " + Gonio.number(s.floor, 2) + " 1/sr) a reading is an upper limit.");
  return parts.join(" ");
};
