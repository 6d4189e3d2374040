"use strict";
(function () {
  const calm = window.matchMedia("(prefers-reduced-motion: reduce)");

  function numbers(text) {
    return new Float32Array(Uint8Array.from(atob(text), (c) => c.charCodeAt(0)).buffer);
  }

  // A moment is the number of a time and a share of the way to the next one, so that both sides of a
  // jump, which is one time twice, can be shown.
  function reader(times) {
    const last = times.length - 1;
    return {
      last,
      value(track, moment, k = 0, wide = 1) {
        const i = Math.min(Math.floor(moment), last), share = moment - i, a = track[i * wide + k];
        return share > 0 ? a + share * (track[(i + 1) * wide + k] - a) : a;
      },
      at(time) {
        let low = 0, high = last;
        while (high - low > 1) {
          const middle = (low + high) >> 1;
          if (times[middle] <= time) low = middle; else high = middle;
        }
        const width = times[high] - times[low];
        return low + (width > 0 ? Math.min(1, Math.max(0, (time - times[low]) / width)) : 0);
      },
    };
  }

  function mover(node, body, tracks, count, value) {
    const path = node.querySelector("path");
    const closed = path.getAttribute("d").endsWith("Z") ? "Z" : "";
    const places = tracks[body.places], values = tracks[body.values], outline = tracks[body.outline];
    const wide = outline && outline.length / count;
    return (moment) => {
      const place = places ? [0, 1, 2].map((k) => value(places, moment, k, 3)) : [];
      const heat = values ? value(values, moment) : 0;
      const seen = ![...place, heat].some(Number.isNaN);
      node.style.display = seen ? "" : "none";
      if (!seen) return;
      if (places) {
        node.setAttribute("transform", `translate(${place[0].toFixed(2)} ${place[1].toFixed(2)})`);
        path.setAttribute("transform", `rotate(${place[2].toFixed(4)})`);
      }
      if (values) path.style.setProperty("--v", heat.toFixed(4));
      if (!outline) return;
      const points = [];
      for (let k = 0; k < wide; k += 2) {
        points.push(`${value(outline, moment, k, wide).toFixed(2)} ${value(outline, moment, k + 1, wide).toFixed(2)}`);
      }
      path.setAttribute("d", `M${points.join("L")}${closed}`);
    };
  }

  // A line in each plot that follows, where its x axis has the moment.
  function marker(figure, track, value) {
    const line = document.createElement("div");
    line.className = "moment";
    figure.append(line);
    return (moment) => {
      const plot = figure.querySelector(".plot"), drawn = plot._fullLayout;
      const x = value(track, moment);
      line.hidden = !drawn || Number.isNaN(x);
      if (line.hidden) return;
      const axis = drawn.xaxis, size = drawn._size, at = axis.l2p(x);
      line.hidden = at < 0 || at > axis._length;
      line.style.left = `${plot.offsetLeft + axis._offset + at - 1}px`;
      line.style.top = `${plot.offsetTop + size.t}px`;
      line.style.height = `${size.h}px`;
    };
  }

  function player(figure) {
    const data = JSON.parse(figure.querySelector(":scope > script").textContent);
    const tracks = data.tracks.map(numbers), times = tracks[data.times];
    const { last, value, at } = reader(times);
    const find = (selector) => figure.querySelector(selector);
    const controls = find(".controls"), button = find(".play"), slider = find("input"), speed = find("select");
    const nodes = figure.querySelectorAll(".moves"), cells = figure.querySelectorAll(".readings dd");
    const followers = [...document.querySelectorAll("figure[data-follows]")].filter((f) => f.dataset.follows === data.name);
    const parts = data.bodies.map((body, k) => mover(nodes[k], body, tracks, times.length, value));
    parts.push(...followers.flatMap((f) => data.marks.map((k) => marker(f, tracks[k], value))));
    parts.push(...data.readings.map((reading, k) => (moment) => {
      const x = value(tracks[reading.track], moment);
      cells[k].textContent = Number.isNaN(x) ? "–" : `${x.toFixed(reading.decimals)} ${reading.unit}`.trimEnd();
    }));
    let moment = data.still, playing = false, seen = false, paper = false, before = 0, next = 0;

    function draw() {
      for (const part of parts) part(paper ? data.still : moment);
    }
    function show(now) {
      moment = now;
      draw();
      slider.value = value(times, now);
      if (!playing && cells.length) slider.setAttribute("aria-valuetext", cells[0].textContent);
    }
    function wait() {
      cancelAnimationFrame(next);
      next = requestAnimationFrame(run);
    }
    function play(on) {
      playing = on;
      button.classList.toggle("playing", on);
      button.setAttribute("aria-label", on ? "Pause" : "Play");
      before = 0;
      if (on) wait(); else show(moment);
    }
    function run(now) {
      if (!playing || !seen) return;
      const passed = before ? Math.min(0.1, (now - before) / 1000) : 0;
      before = now;
      show(at((value(times, moment) + passed * speed.value) % times[last]));
      wait();
    }
    function step(by) {
      play(false);
      const whole = by > 0 ? Math.floor(moment + 1e-6) + 1 : Math.ceil(moment - 1e-6) - 1;
      show((whole + last + 1) % (last + 1));
    }

    controls.hidden = false;
    slider.max = times[last];
    button.addEventListener("click", () => play(!playing));
    find(".back").addEventListener("click", () => step(-1));
    find(".on").addEventListener("click", () => step(1));
    slider.addEventListener("input", () => {
      const time = Number(slider.value);  // before the pause sets it back
      play(false);
      show(at(time));
    });
    figure.addEventListener("keydown", (event) => {
      const by = { ArrowLeft: -1, ArrowDown: -1, ArrowRight: 1, ArrowUp: 1 }[event.key];
      if (event.target === speed) return;
      if (by) step(by);
      else if (event.key === "Home") { play(false); show(0); }
      else if (event.key === "End") { play(false); show(last); }
      else if (event.key === " " && event.target.tagName !== "BUTTON") play(!playing);
      else return;
      event.preventDefault();
    });
    document.addEventListener("drawn", () => {
      for (const f of followers) {
        const plot = f.querySelector(".plot");
        if (plot.on && !plot.dataset.followed) plot.on("plotly_afterplot", draw);
        plot.dataset.followed = "yes";
      }
      draw();
    });
    window.addEventListener("beforeprint", () => { paper = true; draw(); });
    window.addEventListener("afterprint", () => { paper = false; draw(); });
    calm.addEventListener("change", () => { if (calm.matches) play(false); });
    new IntersectionObserver((entries) => {
      seen = entries[entries.length - 1].isIntersecting;
      before = 0;
      if (seen && playing) wait();
    }).observe(figure);
    show(moment);
    if (!calm.matches) play(true);
  }

  for (const figure of document.querySelectorAll("figure.player")) player(figure);
})();
