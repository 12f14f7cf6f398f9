"use strict";
// lines over the last half minute, and the newest value as text
const Plots = (() => {
  const SPAN = 30, COLOURS = ["#18202c", "#9b0005", "#d96e12", "#2b6fd0", "#246e65", "#6747a6", "#8a6d00", "#7a7f87"];
  let plots = [];

  function begin(parent, given) {
    plots = given.map(one => {
      const figure = document.createElement("figure"), title = document.createElement("figcaption");
      const canvas = document.createElement("canvas");
      canvas.setAttribute("role", "img");
      canvas.setAttribute("aria-label", `${one.title}: ${one.none}`);
      title.textContent = one.title;
      figure.append(title, canvas);
      return {...one, title, label: one.title, figure, canvas, points: []};
    });
    parent.replaceChildren(...plots.map(one => one.figure));
  }

  // seconds on any clock; values: one number or null each
  function add(key, time, values) {
    const plot = plots.find(one => one.key === key);
    const last = plot.points.at(-1);
    if (last && (time < last[0] || time > last[0] + SPAN)) plot.points = [];
    plot.points.push([time, values]);
    while (plot.points.length && plot.points[0][0] < time - SPAN) plot.points.shift();
  }

  function draw() {
    for (const plot of plots) {
      const {canvas, points} = plot, ratio = window.devicePixelRatio || 1;
      const width = Math.round(canvas.clientWidth * ratio), height = Math.round(canvas.clientHeight * ratio);
      if (!width || !height || !points.length) continue;
      if (canvas.width !== width || canvas.height !== height) Object.assign(canvas, {width, height});
      const pen = canvas.getContext("2d"), end = points.at(-1)[0];
      const known = points.flatMap(one => one[1]).filter(one => one !== null);
      const most = Math.max(1e-9, ...known) * 1.08;
      pen.clearRect(0, 0, width, height);
      pen.strokeStyle = "#d5dbe1";
      pen.lineWidth = ratio;
      for (const share of [0, 0.5, 1]) { pen.beginPath(); pen.moveTo(0, (height - 2) * share + 1); pen.lineTo(width, (height - 2) * share + 1); pen.stroke(); }
      points[0][1].forEach((_, line) => {
        pen.strokeStyle = COLOURS[line % COLOURS.length];
        pen.lineWidth = 1.8 * ratio;
        pen.setLineDash(line >= COLOURS.length ? [6, 3] : []);
        pen.beginPath();
        let down = false;
        for (const [time, values] of points) {
          if (values[line] === null) { down = false; continue; }
          const x = width * (1 - (end - time) / SPAN), y = height - 2 - (height - 4) * values[line] / most;
          down ? pen.lineTo(x, y) : pen.moveTo(x, y);
          down = true;
        }
        pen.stroke();
      });
      pen.fillStyle = "#4d5866";
      pen.font = `${11 * ratio}px system-ui, sans-serif`;
      pen.fillText(most >= 100 ? most.toFixed(0) : most.toPrecision(2), 3 * ratio, 12 * ratio);
      const newest = points.at(-1)[1].map((value, line) =>
        (plot.names ? plot.names[line] + " " : "") + (value === null ? "–" : value.toFixed(1))).join(", ");
      canvas.setAttribute("aria-label", `${plot.label}: ${newest}`);
    }
  }

  return {begin, add, draw};
})();
