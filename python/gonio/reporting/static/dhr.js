"use strict";
// DHR and DHT over the angle of incidence, with the extrapolated share below.
Gonio.drawIntegrals = () => {
  const element = document.getElementById("plot-dhr");
  if (!element) return;
  const p = Gonio.palette(), traces = [], several = Gonio.data.channels.length > 1;
  const panels = Gonio.integralPanels(p);
  const azimuths = Gonio.azimuths();
  Gonio.data.channels.forEach((channel, c) => {
    for (const component of ["reflection", "transmission"]) {
      azimuths.forEach((phi, a) => {
        const rows = Gonio.data.slices.filter((s) => s.channel === c && (Gonio.normal(s) || Math.abs(s.phi_i - phi) < 1e-3))
          .map((s) => [s.theta_i, s.integrals.find((i) => i.component === component)])
          .filter(([, i]) => i && i.value !== null).sort((one, two) => one[0] - two[0]);
        if (!rows.length) return;
        const reflection = component === "reflection";
        const colour = several ? Gonio.channelColour(channel, c, p) : reflection ? p.data : p.transmitted;
        const name = [reflection ? "DHR" : "DHT", several ? Gonio.text(channel) : "", azimuths.length > 1 ? "φ<sub>i</sub> " + Gonio.angle(phi) : ""].filter(Boolean).join(" · ");
        const u = rows.map(([, i]) => 2 * (i.u || 0));
        const axis = panels.of[component];
        rows.forEach(([, i], k) => { axis.low = Math.min(axis.low, i.value - u[k]); axis.high = Math.max(axis.high, i.value + u[k]); });
        const symbol = (reflection ? ["circle", "square", "star", "hexagon"] : ["diamond", "triangle-up", "x", "pentagon"])[a % 4];
        const known = rows.filter(([, i]) => i.truth !== null);
        known.forEach(([, i]) => { axis.low = Math.min(axis.low, i.truth); axis.high = Math.max(axis.high, i.truth); });
        if (known.length) traces.push({
          type: "scatter", mode: "lines+markers", name: name + " · truth", legendgroup: name, yaxis: axis.id, x: known.map((r) => r[0]), y: known.map((r) => r[1].truth),
          line: { color: p.truth, width: 1.3, dash: "dash" }, marker: { color: p.truth, size: 11, symbol: "line-ew-open", line: { width: 1.6 } },
          text: known.map((r) => Gonio.number(r[1].truth, 4)), hovertemplate: "truth %{text}<extra>" + name + " at %{x}°</extra>",
        });
        traces.push({
          type: "scatter", mode: "lines+markers", name, legendgroup: name, yaxis: axis.id, x: rows.map((r) => r[0]), y: rows.map((r) => r[1].value),
          error_y: { type: "data", array: u, color: colour, thickness: 1.5, width: 5 },
          line: { color: colour, width: 1.2, dash: reflection ? "solid" : "dot" }, marker: { color: colour, size: 8, symbol },
          text: rows.map((r) => Gonio.withUncertainty(r[1].value, r[1].u)), hovertemplate: "%{text} (k = 2)<extra>" + name + " at %{x}°</extra>",
        });
        if (panels.extrapolated) traces.push({
          type: "bar", width: Gonio.barWidth(), name, legendgroup: name, showlegend: false, yaxis: "y2", x: rows.map((r) => r[0]),
          y: rows.map((r) => 100 * (r[1].extrapolated || 0) / (Math.abs(r[1].value) || 1)),
          marker: { color: colour, pattern: { shape: reflection ? "" : "/", fgcolor: colour, bgcolor: p.ground, solidity: .45 }, line: { color: colour, width: 1 } },
          hovertemplate: "%{y:.2f} % extrapolated<extra>" + name + " at %{x}°</extra>",
        });
      });
    }
  });
  const thetas = Gonio.data.incidences.map((i) => i.theta_i), low = Math.min(...thetas), high = Math.max(...thetas);
  Plotly.react(element, traces, Gonio.layout(p, Object.assign({
    barmode: "group", bargap: .5, hovermode: "closest", showlegend: traces.filter((t) => t.type !== "bar").length > 1, legend: { orientation: "h", x: 0, y: -0.14, yanchor: "top" },
    xaxis: Gonio.axis(p, "Angle of incidence θ<sub>i</sub> [deg]", { range: [low - 5, high + 5], anchor: panels.extrapolated ? "y2" : panels.last, dtick: high - low > 40 ? 15 : undefined }),
    margin: { l: 70, r: 16, t: 24, b: 84 },
  }, panels.layout())), Gonio.CONFIG);
};

// One panel for each component that was integrated, so that uncertainties of both can be seen.
Gonio.integralPanels = (p) => {
  const found = ["reflection", "transmission"].filter((c) => Gonio.data.slices.some((s) => s.integrals.some((i) => i.component === c)));
  const of = {}, extrapolated = Gonio.data.slices.some((s) => s.integrals.some((i) => Math.abs(i.extrapolated || 0) >= 5e-5 * Math.abs(i.value)));
  const floor = extrapolated ? .28 : 0, height = (1 - floor - .06 * (found.length - 1)) / Math.max(found.length, 1);
  found.forEach((component, k) => {
    const top = 1 - k * (height + .06), bottom = Math.max(0, top - height);
    of[component] = { id: k ? "y3" : "y", domain: [bottom, top], low: Infinity, high: -Infinity, title: component === "reflection" ? "DHR [1]" : "DHT [1]" };
  });
  const range = (a) => { const pad = Math.max(.12 * (a.high - a.low), .004 * Math.abs(a.high), 1e-4); return [a.low - pad, a.high + pad]; };
  const lower = extrapolated ? { yaxis2: Gonio.axis(p, "extrapolated [%]", { domain: [0, .2], rangemode: "tozero", nticks: 4 }) } : {};
  const layout = () => Object.assign(lower, Object.fromEntries(Object.values(of).map((a) => ["yaxis" + a.id.slice(1), Gonio.axis(p, a.title, { domain: a.domain, range: range(a), nticks: 6 })])));
  return { of, layout, extrapolated, last: found.length > 1 ? "y3" : "y" };
};

// Bars a few degrees wide, however many series share an incidence.
Gonio.barWidth = () => {
  const thetas = [...new Set(Gonio.data.incidences.map((i) => i.theta_i))].sort((a, b) => a - b);
  const steps = thetas.slice(1).map((t, k) => t - thetas[k]);
  const series = Gonio.data.channels.length * Gonio.data.sides.length;
  return Math.min(3, .7 * Math.min(8, ...steps) / series);
};
