"use strict";
(function () {
  const told = JSON.parse(document.getElementById("told").textContent);
  const table = document.querySelector("#designs table");
  const beside = [...document.querySelectorAll("#beside table")];
  const heads = [...table.tHead.rows[0].cells];
  const rows = [...table.tBodies[0].rows];
  const every = rows.map((_, k) => k);
  const count = document.querySelector("#designs .count");
  const plots = () => [...document.querySelectorAll("figure.drawn .plot")].filter((p) => p.data);
  const svg = "http://www.w3.org/2000/svg";
  let pick = told.pair[0], shown = told.pair.at(-1);
  let kept = every;
  let originals = new WeakMap();  // of every plot: its designs before filters

  document.documentElement.classList.add("scripted");

  // Numbers as they are read: "5,782.4" is 5782.4, words stay words.
  function value(text) {
    const plain = text.replace(/,/g, "");
    return plain !== "" && isFinite(plain) ? Number(plain) : text;
  }
  const values = rows.map((row) => [...row.cells].map((cell) => value(cell.textContent)));
  const numeric = heads.map((_, k) => values.every((row) => typeof row[k] === "number"));

  function make(tag, attributes, text) {
    const node = document.createElement(tag);
    for (const [name, said] of Object.entries(attributes)) node.setAttribute(name, said);
    if (text !== undefined) node.textContent = text;
    return node;
  }

  // Gears along the shafts, all designs at one scale: of each x, y, tip and reference radius.
  const ends = [0, 0];
  const room = told.sketches.map((one) => one && [0, 1].map((n) => {
    const low = Math.min(...one.gears.map((g) => g[n] - g[2]), ...(one.box ? [one.box[n]] : []));
    const high = Math.max(...one.gears.map((g) => g[n] + g[2]), ...(one.box ? [one.box[n + 2]] : []));
    ends[n] = Math.max(ends[n], high - low);
    return [low, high];
  }));

  function drawn(tag, attributes, text) {
    const node = document.createElementNS(svg, tag);
    for (const [name, said] of Object.entries(attributes)) node.setAttribute(name, said);
    if (text !== undefined) node.textContent = text;
    return node;
  }

  function sketch(k) {
    const one = told.sketches[k];
    if (!one) return null;
    const [[x0, x1], [y0, y1]] = room[k];
    const scale = Math.min(460 / ends[0], 300 / ends[1]);
    const wide = scale * ends[0], high = scale * ends[1];
    const across = (x) => (wide - scale * (x1 - x0)) / 2 + scale * (x - x0);
    const down = (y) => (high - scale * (y1 - y0)) / 2 + scale * (y1 - y);
    const image = drawn("svg", { viewBox: `-4 -4 ${wide + 8} ${high + 8}`, role: "img", "aria-label": `gears of design ${k + 1}` });
    if (one.box) {
      const [left, bottom, right, top] = one.box;
      image.append(drawn("rect", { class: "box", x: across(left), y: down(top), width: scale * (right - left), height: scale * (top - bottom) }));
    }
    for (const [x, y, tip, reference, stage] of one.gears) {
      for (const [style, r] of [["tip", tip], ["reference", reference]]) {
        image.append(drawn("circle", { class: style, style: `--c: var(--series-${(stage - 1) % 8 + 1})`, cx: across(x), cy: down(y), r: scale * r }));
      }
    }
    for (const [x, y, tip, , , teeth] of one.gears) {
      if (scale * tip > 24) image.append(drawn("text", { x: across(x), y: down(y) - 0.55 * scale * tip }, `z ${teeth}`));
    }
    return image;
  }

  function change(from, to) {
    const a = value(from), b = value(to);
    if (typeof a !== "number" || typeof b !== "number" || a === 0 || a === b) return "";
    const part = 100 * (b / a - 1);
    return `${part < 0 ? "−" : "+"}${Math.abs(part).toFixed(Math.abs(part) < 10 ? 2 : 1)} %`;
  }

  function name(k) {
    return `design ${k + 1}${told.rules[k] ? ` (${told.rules[k]})` : ""}`;
  }

  // The pick on the left, the design that was clicked beside it, and what changes.
  function compare() {
    const both = pick === shown ? [pick] : [pick, shown];
    for (const one of beside) {
      one.tHead.rows[0].replaceChildren(...["", ...both.map(name), ...(both.length > 1 ? ["change"] : [])].map((text) => make("th", { scope: "col" }, text)));
      for (const row of one.tBodies[0].rows) {
        const n = Number(row.dataset.row), limit = n >= told.limits[0] && n < told.limits[1];
        const cells = both.map((k) => {
          const cell = make("td", {}, told.points[k][n]);
          if (limit && told.points[k][n] !== "") {
            const part = told.shares[k][n - told.limits[0]];
            cell.className = part > 0.999999 ? "share full" : "share";
            cell.style.setProperty("--part", part);
          }
          return cell;
        });
        if (both.length > 1) cells.push(make("td", {}, limit ? "" : change(...both.map((k) => told.points[k][n]))));
        row.replaceChildren(row.cells[0], ...cells);
        row.hidden = both.every((k) => told.points[k][n] === "");  // a stage that neither has
      }
      if (both.length > 1 && one.tBodies[0].querySelector(".share")) {  // of limits the bars say what changes
        for (const row of [one.tHead.rows[0], ...one.tBodies[0].rows]) row.lastElementChild.remove();
      }
    }
    document.querySelectorAll("#beside .sketch").forEach((place, n) => {
      const image = n < both.length ? sketch(both[n]) : null;
      place.replaceChildren(...(image ? [make("p", {}, name(both[n])), image] : []));
    });
    rows.forEach((row, k) => row.setAttribute("aria-selected", k === shown));
  }

  document.querySelector("#beside button").addEventListener("click", () => { pick = shown; compare(); });

  function choose(k) {
    if (k === shown) return;
    shown = k;
    compare();
    mark();
  }

  // The design shown beside the pick is marked in every plot; what filters leave out is not drawn.
  const isOf = (kind) => (trace) => trace.meta === kind;
  const axes = (trace) => ["x", "y", "z"].filter((letter) => trace[letter]);

  function mark() {
    for (const place of plots()) {
      const own = originals.get(place), k = place.data.findIndex(isOf("chosen"));
      if (!own || k < 0) continue;
      const at = own.customdata.flatMap((design, n) => (design === shown + 1 ? [n] : []));
      const update = Object.fromEntries(axes(own).map((letter) => [letter, [at.map((n) => own[letter][n])]]));
      Plotly.restyle(place, update, [k]);
    }
  }

  function leave() {
    const there = new Set(kept.map((k) => k + 1));
    for (const place of plots()) {
      const own = originals.get(place), k = place.data.findIndex(isOf("designs"));
      if (!own || k < 0) continue;
      const at = own.customdata.flatMap((design, n) => (there.has(design) ? [n] : []));
      const update = Object.fromEntries([...axes(own), "customdata"].map((key) => [key, [at.map((n) => own[key][n])]]));
      Plotly.restyle(place, update, [k]);
    }
  }

  document.addEventListener("drawn", () => {
    for (const place of plots()) {
      const designs = place.data.find(isOf("designs"));
      if (!designs) continue;
      const own = Object.fromEntries([...axes(designs), "customdata"].map((key) => [key, [...designs[key]]]));
      if (!originals.has(place)) {
        place.on("plotly_click", (event) => {
          const hit = event.points.find((point) => Number.isInteger(point.customdata));
          if (hit) setTimeout(() => choose(hit.customdata - 1));  // a view in space is still drawing
        });
      }
      originals.set(place, own);
    }
    mark();
    if (kept.length < every.length) leave();
  });

  // Sorting by a click on a head, up, then down.
  function sort(k) {
    const down = heads[k].getAttribute("aria-sort") === "ascending";
    const order = [...every].sort((i, j) => {
      const [a, b] = [i, j].map((n) => (k > 0 && k <= told.values[n].length ? told.values[n][k - 1] : values[n][k]));
      const by = typeof a === "number" && typeof b === "number" ? a - b : String(a).localeCompare(String(b), "en", { numeric: true });
      return (down ? -by : by) || i - j;
    });
    heads.forEach((head, n) => head.setAttribute("aria-sort", n !== k ? "none" : down ? "descending" : "ascending"));
    table.tBodies[0].append(...order.map((i) => rows[i]));
  }

  // A least and a largest value of every column of numbers, a part of the words of any other.
  const filters = [];
  function filter() {
    kept = every.filter((i) => filters.every((passes) => passes(values[i])));
    const there = new Set(kept);
    rows.forEach((row, i) => { row.hidden = !there.has(i); });
    const clear = make("button", { type: "button" }, "Show all");
    clear.addEventListener("click", () => {
      table.tHead.querySelectorAll("input").forEach((input) => { input.value = ""; });
      filter();
    });
    const all = kept.length === every.length;
    const words = all ? every.length === 1 ? "One design." : `All ${every.length} designs.` : `${kept.length} of ${every.length} designs.`;
    count.replaceChildren(`${words} Click a column head to sort; write a minimum and a maximum below it to filter.`, ...(all ? [] : [clear]));
    leave();
  }

  function field(k, label, passes) {
    const input = make("input", { type: numeric[k] ? "number" : "search", step: "any", placeholder: label, "aria-label": `${heads[k].textContent}: ${label}` });
    input.addEventListener("input", filter);
    filters.push((row) => input.value === "" || passes(row[k], input.value));
    return input;
  }

  const line = make("tr", { class: "filter" });
  const names = heads.map((head) => head.textContent);
  heads.forEach((head, k) => {
    const cell = make(k ? "td" : "th", head.className ? { class: head.className } : {});
    if (numeric[k] && k) cell.append(field(k, "min", (v, end) => v >= Number(end)), field(k, "max", (v, end) => v <= Number(end)));
    else if (k) cell.append(field(k, "has", (v, part) => String(v).includes(part)));
    line.append(cell);
  });
  heads.forEach((head, k) => {
    const button = make("button", { type: "button", title: "sort" }, names[k]);
    button.addEventListener("click", () => sort(k));
    head.replaceChildren(button);
  });
  table.tHead.append(line);
  rows.forEach((row, k) => {
    row.tabIndex = 0;
    row.addEventListener("click", () => choose(k));
    row.addEventListener("keydown", (event) => {
      if (event.key === "Enter" || event.key === " ") { event.preventDefault(); choose(k); }
    });
  });

  // Long addresses are too much for some browsers: the same as a file in memory.
  for (const link of document.querySelectorAll("a[download]")) {
    link.addEventListener("click", () => {
      const [head, text] = link.href.split(/,(.*)/s);
      if (!head.startsWith("data:")) return;
      const bytes = head.endsWith("base64") ? Uint8Array.from(atob(text), (c) => c.charCodeAt(0)) : new TextEncoder().encode(decodeURIComponent(text));
      link.href = URL.createObjectURL(new Blob([bytes], { type: head.slice(5).split(";")[0] }));
    });
  }

  compare();
  filter();
})();
