"use strict";
(function () {
  const root = document.documentElement;
  const dark = window.matchMedia("(prefers-color-scheme: dark)");
  const options = { displaylogo: false, displayModeBar: false, responsive: true };
  const narrow = 560;
  const sheet = 660;  // px across a printed page, as in row.py
  const half = 390;  // of a plot beside another one there

  function colour(style, word) {
    const [, name, opacity] = word.match(/^(--[\w-]+)(?:\/([\d.]+))?$/);
    const value = style.getPropertyValue(name).trim();
    if (!opacity) return value;
    const [r, g, b] = [1, 3, 5].map((k) => parseInt(value.slice(k, k + 2), 16));
    return `rgba(${r},${g},${b},${opacity})`;
  }

  function resolved(style, part) {
    if (typeof part === "string") return part.startsWith("--") ? colour(style, part) : part;
    if (Array.isArray(part)) return part.map((one) => resolved(style, one));
    if (part === null || typeof part !== "object") return part;
    return Object.fromEntries(Object.entries(part).map(([k, v]) => [k, resolved(style, v)]));
  }

  // A view in space, which print would leave empty, stays a still without WebGL.
  const turns = !!document.createElement("canvas").getContext("webgl");

  // A printed page is laid out after beforeprint: plots are told the width that they will have.
  function beside(place) {
    const section = place.closest("section.half");
    return section && [section.previousElementSibling, section.nextElementSibling]
      .some((next) => next && next.classList.contains("half"));
  }

  function draw() {
    const style = getComputedStyle(root);
    for (const place of document.querySelectorAll(turns ? ".plot" : "figure:not(.space) > .plot")) {
      const spec = JSON.parse(place.parentElement.querySelector("script").textContent);
      const { data, layout } = resolved(style, spec);
      if (place.clientWidth < narrow) layout.font.size = 11;
      if (root.classList.contains("paper")) layout.width = sheet;
      if (root.classList.contains("paper") && beside(place)) layout.width = half;
      place.parentElement.classList.add("drawn");  // a still made way for it
      Plotly.react(place, data, layout, options);
    }
    document.dispatchEvent(new Event("drawn"));
  }

  // Words and tables are seen before the plotting library, which is large, is even read.
  function begin() {
    if (window.Plotly) return;
    const library = document.createElement("script");
    library.textContent = document.getElementById("plotly").textContent;
    document.head.append(library);
    draw();
  }

  dark.addEventListener("change", () => { if (window.Plotly) draw(); });
  window.addEventListener("beforeprint", () => { root.classList.add("paper"); begin(); draw(); });
  window.addEventListener("afterprint", () => { root.classList.remove("paper"); draw(); });
  new PerformanceObserver(begin).observe({ type: "paint", buffered: true });
  setTimeout(begin, 3000);  // where a browser tells of no paint
})();
