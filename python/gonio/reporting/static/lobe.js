"use strict";
// The lobe in space: readings at a radius that grows with the value, joined to a surface where neighbours exist.
Gonio.COLOURS = "Viridis";

Gonio.webgl = (() => {
  try {
    const canvas = document.createElement("canvas");
    return Boolean(canvas.getContext("webgl2") || canvas.getContext("webgl"));
  } catch (error) { return false; }
})();

Gonio.colourAxis = (range, log, title) => {
  if (!log || !range.positive) return { cmin: 0, cmax: range.high || 1, bar: { title: { text: title, side: "right" }, exponentformat: "power" } };
  const low = Math.log10(range.low), high = Math.log10(range.high), ticks = Gonio.decadeTicks(low, high);
  return { cmin: low, cmax: high, bar: { title: { text: title, side: "right" }, tickvals: ticks.values, ticktext: ticks.labels } };
};

Gonio.radius = (range, log) => {
  if (!range.positive) return () => 0;
  if (!log) return (v) => (v > 0 ? v / range.high : 0);
  const low = Math.log10(range.low) - 0.3, span = Math.log10(range.high) - low;
  return (v) => (v > 0 ? Math.max(0, (Math.log10(v) - low) / span) : 0);
};

Gonio.drawLobe = (s, state) => {
  const element = document.getElementById("plot-lobe"), caption = document.getElementById("lobe-caption");
  if (!Gonio.webgl) {
    element.style.height = "auto";
    caption.textContent = "This browser offers no WebGL, so the lobe cannot be drawn in space. The profile and the maps show the same readings.";
    return null;
  }
  const p = Gonio.palette(), range = Gonio.range(state), log = state.log, unit = Gonio.label(state) + " [1/sr]";
  const radius = Gonio.radius(range, log), axis = Gonio.colourAxis(range, log, unit), traces = [];
  s.sides.forEach((side, k) => {
    const values = Gonio.values(side, state.quantity), n = side.n, x = new Float32Array(n), y = new Float32Array(n), z = new Float32Array(n), c = new Float32Array(n);
    for (let j = 0; j < n; j += 1) {
      const v = values[j], r = Number.isFinite(v) ? Math.min(radius(v), 1.15) : 0;
      x[j] = r * side.x[j]; y[j] = r * side.y[j]; z[j] = r * side.z[j];
      c[j] = log && range.positive ? Math.log10(Math.max(v, range.low)) : Math.max(v, 0);
    }
    const label = (j) => "θ<sub>s</sub> " + Gonio.angle(side.theta[j]) + ", φ<sub>s</sub> " + Gonio.angle(side.phi[j]) + "<br>" + Gonio.number(values[j], 4) + " 1/sr";
    const text = Array.from({ length: n }, (_, j) => label(j));
    const m = side.triangles.length / 3;
    if (m) {
      const i = new Array(m), jj = new Array(m), kk = new Array(m);
      for (let t = 0; t < m; t += 1) { i[t] = side.triangles[3 * t]; jj[t] = side.triangles[3 * t + 1]; kk[t] = side.triangles[3 * t + 2]; }
      traces.push({
        type: "mesh3d", x, y, z, i, j: jj, k: kk, intensity: c, cmin: axis.cmin, cmax: axis.cmax, colorscale: Gonio.COLOURS, showscale: false,
        flatshading: false,
        lighting: { ambient: .62, diffuse: .55, specular: .12, roughness: .7, fresnel: .1 }, lightposition: { x: 2000, y: -3000, z: 4000 }, text, hoverinfo: "text", name: side.component,
      });
    }
    if (state.readings || !m) traces.push({ type: "scatter3d", mode: "markers", x, y, z, text, hoverinfo: "text", marker: { size: m ? 1.4 : 3, color: m ? p.ink : c, opacity: m ? .55 : 1, colorscale: Gonio.COLOURS, cmin: axis.cmin, cmax: axis.cmax }, showlegend: false });
  });
  traces.push(...Gonio.lobeFrame(s, range, log, p));
  const none = { visible: false, showspikes: false };
  const back = s.sides.some((side) => side.side === "back"), front = s.sides.some((side) => side.side === "front");
  const turn = (s.phi_i + 90) * Math.PI / 180;
  Plotly.react(element, traces, Gonio.layout(p, {
    margin: { l: 0, r: 0, t: 0, b: 0 }, showlegend: false, uirevision: "lobe",
    scene: {
      xaxis: Object.assign({ range: [-1.3, 1.3] }, none), yaxis: Object.assign({ range: [-1.3, 1.3] }, none), zaxis: Object.assign({ range: [back ? -1.3 : -0.25, front ? 1.3 : 0.25] }, none), aspectmode: "data",
      camera: { eye: { x: 1.3 * Math.cos(turn) + .3 * Math.cos(turn + 1.57), y: 1.3 * Math.sin(turn) + .3 * Math.sin(turn + 1.57), z: back && front ? .45 : back ? -.5 : .6 }, center: { x: 0, y: 0, z: back && front ? 0 : back ? 0.1 : -0.1 } }, uirevision: "lobe",
    },
  }), Object.assign({}, Gonio.CONFIG, { toImageButtonOptions: { format: "png", scale: 2, filename: "gonio-lobe" } }));
  if (!range.positive) caption.textContent = "No reading is positive, so there is no lobe to draw; the directions are shown for orientation.";
  else caption.textContent = log
    ? "Radius and colour (as in the maps): " + Gonio.label(state) + " on a logarithmic scale, from " + Gonio.number(range.low * 10 ** -0.3, 2) + " at the centre to " + Gonio.number(range.high, 3) + " 1/sr at the outer ring; rings in the sample plane mark the values written on them. Open patches were not measured. Drag to rotate."
    : "Radius and colour (as in the maps): " + Gonio.label(state) + " on a linear scale up to " + Gonio.number(range.high, 3) + " 1/sr at the outer ring. Open patches were not measured. Drag to rotate.";
  return element;
};

// Sample plane with rings, the zero-azimuth mark, and the directions of incidence, mirror and unbent transmission.
Gonio.lobeFrame = (s, range, log, p) => {
  const traces = [], ring = { x: [], y: [], z: [] }, text = { x: [], y: [], z: [], t: [] };
  const circle = (r) => { for (let a = 0; a <= 360; a += 4) { const f = a * Math.PI / 180; ring.x.push(r * Math.cos(f)); ring.y.push(r * Math.sin(f)); ring.z.push(0); } ring.x.push(null); ring.y.push(null); ring.z.push(null); };
  const radius = Gonio.radius(range, log);
  circle(1);
  if (range.positive) {
    const marks = log ? Gonio.decadeTicks(Math.log10(range.low), Math.log10(range.high)) : { values: [.25, .5, .75].map((v) => v * range.high), labels: [.25, .5, .75].map((v) => Gonio.number(v * range.high, 2)) };
    const f = (s.phi_i + 45) * Math.PI / 180;
    marks.values.forEach((value, k) => {
      const r = radius(log ? 10 ** value : value);
      if (r < .08 || r > .97) return;
      circle(r);
      if (k % Math.ceil(marks.values.length / 5) === 0) { text.x.push(r * Math.cos(f)); text.y.push(r * Math.sin(f)); text.z.push(0); text.t.push(marks.labels[k]); }
    });
  }
  traces.push({ type: "scatter3d", mode: "lines", x: ring.x, y: ring.y, z: ring.z, line: { color: p.quiet, width: 1.5 }, opacity: .55, hoverinfo: "skip" });
  text.x.push(1.05); text.y.push(0); text.z.push(0); text.t.push("φ = 0°");
  traces.push({ type: "scatter3d", mode: "lines", x: [1, 1.09], y: [0, 0], z: [0, 0], line: { color: p.ink, width: 3 }, hoverinfo: "skip" });
  const place = text.t.map((_, k) => (k === text.t.length - 1 ? "bottom center" : "middle center"));
  for (const m of Gonio.landmarks(s)) {
    if (m.name === "through" && !s.sides.some((side) => side.component === "transmission")) continue;
    if (m.name === "mirror" && !s.sides.some((side) => side.component === "reflection")) continue;
    const [x, y, z] = Gonio.vector(m.theta, m.phi), to = 1.1;
    const colour = m.name === "incidence" ? p.negative : p.ink;
    traces.push({ type: "scatter3d", mode: "lines", x: [0, to * x], y: [0, to * y], z: [0, to * z], line: { color: colour, width: m.name === "incidence" ? 5 : 3, dash: m.dash }, hoverinfo: "skip" });
    if (m.name === "incidence") traces.push({ type: "cone", x: [.62 * x], y: [.62 * y], z: [.62 * z], u: [-x], v: [-y], w: [-z], sizemode: "absolute", sizeref: .12, anchor: "center", showscale: false, colorscale: [[0, colour], [1, colour]], hoverinfo: "skip" });
    const same = text.t.findIndex((_, k) => Math.hypot(text.x[k] - 1.17 * x, text.y[k] - 1.17 * y, text.z[k] - 1.17 * z) < .05);
    if (same >= 0) text.t[same] += " = " + m.name;
    else { text.x.push(1.17 * x); text.y.push(1.17 * y); text.z.push(1.17 * z); text.t.push(m.name); place.push("middle center"); }
  }
  traces.push({ type: "scatter3d", mode: "text", x: text.x, y: text.y, z: text.z, text: text.t, textposition: place, textfont: { size: 12, color: p.ink }, hoverinfo: "skip" });
  return traces;
};
