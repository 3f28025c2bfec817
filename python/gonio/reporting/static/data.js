"use strict";
// The measurement: decoded when a slice is first shown.
Gonio.data = JSON.parse(document.getElementById("gonio-data").textContent);
Gonio.facts = JSON.parse(document.getElementById("gonio-facts").textContent);

Gonio.decode = (base64, Type) => {
  const binary = atob(base64), bytes = new Uint8Array(binary.length);
  for (let k = 0; k < binary.length; k += 1) bytes[k] = binary.charCodeAt(k);
  return new Type(bytes.buffer);
};

Gonio.find = (incidence, channel) => {
  const k = Gonio.data.slices.findIndex((s) => s.incidence === incidence && s.channel === channel);
  return k < 0 ? null : Gonio.open(k);
};

Gonio.open = (k) => {
  const s = Gonio.data.slices[k];
  if (s.opened) return s;
  s.index = k;
  for (const side of s.sides) {
    for (const name of ["theta", "phi", "dsf"]) side[name] = Gonio.decode(side[name], Float32Array);
    side.triangles = Gonio.decode(side.triangles, side.n < 65536 ? Uint16Array : Int32Array);
    Gonio.place(side);
  }
  const p = s.profile;
  for (const part of [p, p.marks]) for (const name of ["x", "y", "u"]) part[name] = Gonio.decode(part[name], Float32Array);
  p.marks.noise = Gonio.decode(p.marks.noise, Uint8Array);
  for (const r of Gonio.data.references) p.references[r.name] = Gonio.decode(p.references[r.name], Float32Array);
  s.opened = true;
  return s;
};

// Unit vectors and the equal-area map of a hemisphere: both sides seen from the front, rim at radius 1.
Gonio.place = (side) => {
  const n = side.n;
  for (const name of ["x", "y", "z", "mx", "my", "cosine"]) side[name] = new Float32Array(n);
  for (let k = 0; k < n; k += 1) {
    const [x, y, z] = Gonio.vector(side.theta[k], side.phi[k]);
    const scale = 1 / Math.sqrt(1 + Math.abs(z));
    side.x[k] = x; side.y[k] = y; side.z[k] = z; side.cosine[k] = Math.abs(z);
    side.mx[k] = x * scale; side.my[k] = y * scale;
  }
};

Gonio.vector = (theta, phi) => {
  const t = theta * Math.PI / 180, f = phi * Math.PI / 180;
  return [Math.sin(t) * Math.cos(f), Math.sin(t) * Math.sin(f), Math.cos(t)];
};

Gonio.onMap = (theta, phi) => {
  const [x, y, z] = Gonio.vector(theta, phi), scale = 1 / Math.sqrt(1 + Math.abs(z));
  return [x * scale, y * scale];
};

// The directions every figure marks.
Gonio.landmarks = (s) => {
  const opposite = (s.phi_i + 180) % 360;
  return [
    { name: "incidence", theta: s.theta_i, phi: s.phi_i, dash: "solid", symbol: "triangle-up" },
    { name: "mirror", theta: s.theta_i, phi: opposite, dash: "dash", symbol: "circle-open" },
    { name: "through", theta: 180 - s.theta_i, phi: opposite, dash: "dot", symbol: "diamond-open" },
  ];
};

// At the normal an azimuth of incidence means nothing.
Gonio.normal = (i) => i.theta_i < 0.01 || i.theta_i > 179.99;

// Azimuths of the oblique incidences, or the only one there is.
Gonio.azimuths = () => {
  const oblique = Gonio.data.incidences.filter((i) => !Gonio.normal(i));
  return [...new Set((oblique.length ? oblique : Gonio.data.incidences.slice(0, 1)).map((i) => i.phi_i))];
};

// Values of the chosen quantity at the readings of a hemisphere; a BSDF within 0.6 degrees of the horizon is left out.
Gonio.values = (side, quantity) => {
  if (quantity === "dsf") return side.dsf;
  side.bsdf = side.bsdf || side.dsf.map((d, k) => (side.cosine[k] > 0.01 ? d / side.cosine[k] : NaN));
  return side.bsdf;
};

Gonio.label = (state) => (state.quantity === "dsf" ? "DSF" : "BSDF");

// Range of the values that figures share: {low, high} in 1/sr. `low` is never under the noise floor or six decades down.
Gonio.range = (state) => {
  const shown = state.common
    ? Gonio.data.slices.map((s, k) => (s.channel === state.channel ? k : -1)).filter((k) => k >= 0)
    : [Gonio.data.slices.findIndex((s) => s.incidence === state.incidence && s.channel === state.channel)];
  let high = -Infinity, low = Infinity;
  for (const k of shown) {
    if (k < 0) continue;
    const s = state.quantity === "bsdf" ? Gonio.open(k) : Gonio.data.slices[k];
    let top = s.peak;
    if (state.quantity === "bsdf") {
      top = -Infinity;
      for (const side of s.sides) {
        const f = Gonio.values(side, "bsdf");
        for (let j = 0; j < f.length; j += 1) if (side.cosine[j] > 0.05 && f[j] > top) top = f[j];
      }
    }
    if (top > high) high = top;
    const weak = Math.max(s.weak || 0, s.floor || 0);
    if (weak > 0 && weak < low) low = weak;
  }
  if (!(high > 0)) return { low: 0, high: Number.isFinite(high) ? Math.max(high, 0) : 1, positive: false };
  if (!Number.isFinite(low)) low = high * 1e-3;
  low = Math.min(Math.max(low, high * 1e-6), high / 2);
  return { low, high, positive: true };
};
