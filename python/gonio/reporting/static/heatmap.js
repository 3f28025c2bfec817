"use strict";
// Equal-area maps of the two hemispheres, filled from the triangles between readings and from nothing else.
Gonio.GRID = 300;

Gonio.raster = (side, values) => {
  const n = Gonio.GRID, z = Array.from({ length: n }, () => new Array(n).fill(null)), tri = side.triangles, half = n / 2;
  for (let t = 0; t < tri.length; t += 3) {
    const a = tri[t], b = tri[t + 1], c = tri[t + 2];
    const ax = (side.mx[a] + 1) * half - .5, ay = (side.my[a] + 1) * half - .5, bx = (side.mx[b] + 1) * half - .5, by = (side.my[b] + 1) * half - .5;
    const cx = (side.mx[c] + 1) * half - .5, cy = (side.my[c] + 1) * half - .5, area = (bx - ax) * (cy - ay) - (cx - ax) * (by - ay);
    if (Math.abs(area) < 1e-12) continue;
    const x0 = Math.max(0, Math.ceil(Math.min(ax, bx, cx))), x1 = Math.min(n - 1, Math.floor(Math.max(ax, bx, cx)));
    const y0 = Math.max(0, Math.ceil(Math.min(ay, by, cy))), y1 = Math.min(n - 1, Math.floor(Math.max(ay, by, cy)));
    for (let y = y0; y <= y1; y += 1) {
      for (let x = x0; x <= x1; x += 1) {
        const w1 = ((x - ax) * (cy - ay) - (cx - ax) * (y - ay)) / area, w2 = ((bx - ax) * (y - ay) - (x - ax) * (by - ay)) / area;
        if (w1 >= -1e-6 && w2 >= -1e-6 && w1 + w2 <= 1 + 1e-6) z[y][x] = values[a] + w1 * (values[b] - values[a]) + w2 * (values[c] - values[a]);
      }
    }
  }
  Gonio.keepPeaks(side, values, z);
  return z;
};

// A reading between two pixels is not lost: its pixel shows the highest reading in it.
Gonio.keepPeaks = (side, values, z) => {
  const n = Gonio.GRID;
  if (!side.triangles.length) return;
  for (let k = 0; k < side.n; k += 1) {
    const x = Math.min(n - 1, Math.max(0, Math.floor((side.mx[k] + 1) * n / 2))), y = Math.min(n - 1, Math.max(0, Math.floor((side.my[k] + 1) * n / 2)));
    if (z[y][x] !== null && values[k] > z[y][x]) z[y][x] = values[k];
  }
};

Gonio.drawMap = (s, state) => {
  const p = Gonio.palette(), range = Gonio.range(state), log = state.log && range.positive, unit = Gonio.label(state) + " [1/sr]";
  const axis = Gonio.colourAxis(range, log, unit), traces = [], shapes = [], annotations = [], n = s.sides.length || 1;
  const grid = Array.from({ length: Gonio.GRID }, (_, k) => (k + .5) / Gonio.GRID * 2 - 1), layout = {};
  let negative = false, noise = false;
  s.sides.forEach((side, k) => {
    const id = k ? String(k + 1) : "", values = Gonio.values(side, state.quantity), z = Gonio.raster(side, values);
    const shown = z.map((row) => row.map((v) => (v === null || !Number.isFinite(v) ? null : log ? (v > 0 ? Math.log10(Math.max(v, range.low)) : null) : v)));
    const below = Gonio.belowFloor(z, grid, s.floor, state);
    const any = below.some((row) => row.some((v) => v !== null));
    for (const row of below) for (const v of row) { negative = negative || v === 2; noise = noise || v === 0; }
    if (side.triangles.length) {
      const text = z.map((row, iy) => row.map((v, ix) => (v === null ? "" : Gonio.mapLabel(grid[ix], grid[iy], side.side, v))));
      traces.push({ type: "heatmap", x: grid, y: grid, z: shown, text, hovertemplate: "%{text}<extra></extra>", xaxis: "x" + id, yaxis: "y" + id, zmin: axis.cmin, zmax: axis.cmax, colorscale: Gonio.COLOURS, zsmooth: false, showscale: k === 0, hoverongaps: false,
        colorbar: Gonio.lyingBar(axis.bar) });
      if (any) traces.push({ type: "heatmap", x: grid, y: grid, z: below, xaxis: "x" + id, yaxis: "y" + id, zmin: 0, zmax: 2, colorscale: [[0, p["noise-a"]], [.3, p["noise-a"]], [.3, p["noise-b"]], [.7, p["noise-b"]], [.7, p.negative], [1, p.negative]], showscale: false, hoverinfo: "skip" });
    }
    const alone = !side.triangles.length;
    if (state.readings || alone) {
      const colours = Array.from(values, (v) => (log ? Math.log10(Math.max(v, range.low)) : v));
      const marker = alone ? { size: 6, color: colours, colorscale: Gonio.COLOURS, cmin: axis.cmin, cmax: axis.cmax, showscale: k === 0, colorbar: Gonio.lyingBar(axis.bar) } : { size: 2, color: p.ink, opacity: .5 };
      traces.push({ type: "scatter", mode: "markers", x: Array.from(side.mx), y: Array.from(side.my), xaxis: "x" + id, yaxis: "y" + id, marker, showlegend: false, text: Array.from(values, (v) => Gonio.number(v, 4) + " 1/sr"), hovertemplate: "%{text}<extra></extra>" });
    }
    traces.push(Gonio.mapLandmarks(s, side, id, p));
    Gonio.mapGrid(side, id, p, shapes, annotations);
    const from = k * (1 / n) + (k ? .015 : 0), to = (k + 1) / n - (k < n - 1 ? .015 : 0);
    const common = { range: [-1.2, 1.2], visible: false, fixedrange: false };
    layout["xaxis" + id] = Object.assign({ domain: [from, to], anchor: "y" + id }, common);
    layout["yaxis" + id] = Object.assign({}, common, { range: [-1.18, 1.3], domain: [0, 1], anchor: "x" + id, scaleanchor: "x" + id, scaleratio: 1 });
  });
  Plotly.react("plot-map", traces, Gonio.layout(p, Object.assign(layout, { shapes, annotations, showlegend: false, margin: { l: 4, r: 4, t: 4, b: 56 } })), Gonio.CONFIG);
  Gonio.mapCaption(s, negative, noise);
};

// Pixels that colour may not speak for: 0 and 1 are the stripes of values within the noise, 2 is clearly negative.
Gonio.belowFloor = (z, grid, floor, state) => z.map((row, iy) => row.map((v, ix) => {
  if (v === null || !Number.isFinite(v)) return null;
  const dsf = state.quantity === "bsdf" ? v * Math.max(0, 1 - grid[ix] ** 2 - grid[iy] ** 2) : v;
  if (floor && Math.abs(dsf) < floor) return (ix + iy) % 8 < 4 ? 0 : 1;
  return dsf < 0 ? 2 : null;
}));

// A colour bar below the maps leaves them the whole width.
Gonio.lyingBar = (bar) => Object.assign({ orientation: "h", thickness: 11, len: .7, y: -0.02, yanchor: "top", outlinewidth: 0 }, bar, { title: { text: bar.title.text, side: "top", font: { size: 12 } }, tickfont: { size: 11 } });

Gonio.mapLabel = (x, y, side, v) => {
  const r = Math.min(1, Math.hypot(x, y)), z = 1 - r * r, theta = Math.acos(Math.max(-1, Math.min(1, z))) * 180 / Math.PI;
  const phi = (Math.atan2(y, x) * 180 / Math.PI + 360) % 360;
  return "θ<sub>s</sub> " + (side === "front" ? theta : 180 - theta).toFixed(1) + "°, φ<sub>s</sub> " + phi.toFixed(1) + "°<br>" + Gonio.number(v, 4) + " 1/sr";
};

Gonio.mapLandmarks = (s, side, id, p) => {
  const shown = Gonio.landmarks(s).filter((m) => (m.theta > 90 ? "back" : "front") === side.side);
  const at = shown.map((m) => Gonio.onMap(m.theta, m.phi));
  return { type: "scatter", mode: "markers", x: at.map((a) => a[0]), y: at.map((a) => a[1]), xaxis: "x" + id, yaxis: "y" + id, text: shown.map((m) => m.name), hovertemplate: "%{text}<extra></extra>", showlegend: false,
    marker: { symbol: shown.map((m) => m.symbol), size: 11, color: "#ffffff", line: { width: 2, color: shown.map(() => "#d1246f") } } };
};

Gonio.mapGrid = (side, id, p, shapes, annotations) => {
  const xref = "x" + id, yref = "y" + id;
  shapes.push({ type: "circle", xref, yref, x0: -1, x1: 1, y0: -1, y1: 1, line: { width: 0 }, fillcolor: p.unmeasured, layer: "below" });
  for (const theta of [30, 60, 90]) {
    const r = Math.sqrt(1 - Math.cos(theta * Math.PI / 180));
    shapes.push({ type: "circle", xref, yref, x0: -r, x1: r, y0: -r, y1: r, line: { color: theta === 90 ? p.quiet : "rgba(255,255,255,.55)", width: 1 } });
    if (theta < 90) annotations.push({ xref, yref, x: r * Math.cos(1.309), y: r * Math.sin(1.309), text: (side.side === "front" ? theta : 180 - theta) + "°", showarrow: false, font: { size: 10.5, color: "#ffffff" }, bgcolor: "rgba(0,0,0,.35)", borderpad: 1 });
  }
  for (let a = 0; a < 360; a += 45) {
    const c = Math.cos(a * Math.PI / 180), v = Math.sin(a * Math.PI / 180);
    shapes.push({ type: "line", xref, yref, x0: c, x1: 1.03 * c, y0: v, y1: 1.03 * v, line: { color: p.quiet, width: 1 } });
    if (a % 90 === 0) annotations.push({ xref, yref, x: 1.1 * c, y: 1.09 * v, text: (a === 0 ? "φ " : "") + a + "°", showarrow: false, font: { size: 10.5, color: p.quiet } });
  }
  annotations.push({ xref, yref, x: -1.15, y: 1.24, xanchor: "left", text: "<b>" + side.component + "</b> · " + side.side, showarrow: false, font: { size: 12.5, color: p.ink } });
};

Gonio.mapCaption = (s, negative, noise) => {
  const caption = document.getElementById("map-caption"), legend = [];
  const add = (kind, meaning) => { const swatch = document.createElement("span"); swatch.className = "swatch " + kind; legend.push(swatch, meaning + "  "); };
  add("gap", "not measured");
  if (noise) add("noise", "below the noise floor");
  if (negative) add("negative", "negative beyond the noise");
  const parts = ["Equal-area map" + (s.sides.length > 1 ? "s, both" : ",") + " seen from the front: azimuth runs counter-clockwise, the rim is the horizon."];
  parts.push("Marks: ▲ incidence" + (s.sides.some((d) => d.component === "reflection") ? ", ○ mirror" : "") + (s.sides.some((d) => d.component === "transmission") ? ", ◇ unbent transmission" : "") + ".");
  if (Gonio.data.fwhm) parts.push("Resolution " + Gonio.number(Gonio.data.fwhm, 3) + "°.");
  caption.replaceChildren(...legend, document.createElement("br"), parts.join(" "));
};
