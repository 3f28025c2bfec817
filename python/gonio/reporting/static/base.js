"use strict";
// One name for everything the page's scripts share.
const Gonio = {};

Gonio.SUPERSCRIPT = { "-": "⁻", 0: "⁰", 1: "¹", 2: "²", 3: "³", 4: "⁴", 5: "⁵", 6: "⁶", 7: "⁷", 8: "⁸", 9: "⁹" };

Gonio.power = (n) => "10" + String(n).split("").map((c) => Gonio.SUPERSCRIPT[c]).join("");

// A number with `digits` significant digits, a real minus sign and powers of ten written out.
Gonio.number = (value, digits = 3) => {
  if (value === null || value === undefined || !Number.isFinite(value)) return "no value";
  if (value === 0) return "0";
  const exponent = Math.floor(Math.log10(Math.abs(value)));
  const text = exponent >= -3 && exponent < 6
    ? value.toFixed(Math.max(0, digits - 1 - exponent))
    : (value / 10 ** exponent).toFixed(digits - 1) + "·" + Gonio.power(exponent);
  return text.replace("-", "−");
};

// Value and expanded uncertainty (k = 2) to the same decimal place.
Gonio.withUncertainty = (value, u) => {
  const expanded = 2 * u;
  if (!Number.isFinite(value) || !(expanded > 0)) return Gonio.number(value, 4);
  const places = 1 - Math.floor(Math.log10(expanded));
  if (places < 0 || places > 6) return Gonio.number(value, 4) + " ± " + Gonio.number(expanded, 2);
  return value.toFixed(places).replace("-", "−") + " ± " + expanded.toFixed(places);
};

// Text for Plotly, which reads a few HTML tags in its labels.
Gonio.text = (s) => String(s).replace(/&/g, "&amp;").replace(/</g, "&lt;").replace(/>/g, "&gt;");

Gonio.angle = (degrees) => String(Math.round(degrees * 100) / 100).replace("-", "−") + "°";

Gonio.colour = (name) => getComputedStyle(document.documentElement).getPropertyValue("--" + name).trim();

Gonio.palette = () => {
  const names = ["ground", "panel", "ink", "quiet", "line", "data", "band", "mark", "negative", "truth", "model",
    "unmeasured", "noise-a", "noise-b", "transmitted", "sum", "accent"];
  return Object.fromEntries(names.map((n) => [n, Gonio.colour(n)]));
};

Gonio.channelColour = (name, k, p) => {
  const known = { red: "#c8323c", green: "#2f8f4e", blue: "#3367d6" };
  const others = matchMedia("screen and (prefers-color-scheme: dark)").matches
    ? [p.data, "#f7a35c", "#c29be8", "#5cc79a", "#d9bd4a", "#ff7ab8"]
    : [p.data, "#c2560a", "#7b4fa3", "#14704f", "#8a6d00", "#b0206a"];
  return known[name] || others[k % others.length];
};

Gonio.CONFIG = { displaylogo: false, displayModeBar: "hover", showSendToCloud: false, plotlyServerURL: "",
  toImageButtonOptions: { format: "svg", filename: "gonio" }, responsive: true, modeBarButtonsToRemove: ["select2d", "lasso2d", "autoScale2d"] };

Gonio.layout = (p, extra) => Object.assign({
  paper_bgcolor: "rgba(0,0,0,0)", plot_bgcolor: "rgba(0,0,0,0)",
  font: { family: "system-ui, Segoe UI, Roboto, Helvetica Neue, Noto Sans, Arial, sans-serif", size: 12.5, color: p.ink },
  hoverlabel: { bgcolor: p.panel, bordercolor: p.line, font: { color: p.ink } },
  modebar: { bgcolor: "rgba(0,0,0,0)", color: p.quiet, activecolor: p.accent },
  margin: { l: 70, r: 16, t: 14, b: 48 },
}, extra);

Gonio.axis = (p, title, extra) => Object.assign({
  title: { text: title, standoff: 8, font: { size: 13 } }, gridcolor: p.line, linecolor: p.quiet, zeroline: false, showline: true, ticks: "outside",
  tickcolor: p.quiet, ticklen: 4, automargin: true,
}, extra);

// Decades between two exponents, thinned to at most about eight labels, with 2 and 5 between when there are few.
Gonio.decadeTicks = (low, high) => {
  const values = [], labels = [];
  const fine = high - low < 2.2, step = Math.max(1, Math.ceil((high - low) / 8));
  for (let e = Math.floor(low); e <= Math.ceil(high); e += 1) {
    for (const m of fine ? [1, 2, 5] : [1]) {
      const at = e + Math.log10(m);
      if (at < low - 1e-9 || at > high + 1e-9 || (!fine && (e % step) !== 0)) continue;
      values.push(at);
      labels.push(fine ? Gonio.number(m * 10 ** e, 1) : Gonio.power(e));
    }
  }
  return { values, labels };
};
