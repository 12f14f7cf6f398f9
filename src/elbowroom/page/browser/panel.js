"use strict";
// what a moment comes to, as text: the same in a run, a recording and a report
const Panel = (() => {
  const at = id => document.getElementById(id);
  let hello = null, ask = () => {}, chosen = null;

  const word = (key, values = {}) =>
    (hello ? hello.words[key] : "").replace(/\{(\w+)\}/g, (_, name) => values[name] ?? "");

  function element(tag, text, className) {
    const made = document.createElement(tag);
    if (text !== undefined) made.textContent = text;
    if (className) made.className = className;
    return made;
  }

  function setText(node, text) { if (node.textContent !== text) node.textContent = text; }

  function begin(said, asks) {
    hello = said;
    ask = asks;
    const legend = at("legend");
    legend.replaceChildren(...said.legend.map(one => {
      const item = element("li"), colour = element("i");
      colour.style.background = one.colour;
      item.append(colour, one.text);
      return item;
    }));
    setText(at("near"), said.near);
    const motions = at("motions").tBodies[0];
    motions.replaceChildren(...said.motions.map((name, number) => {
      const row = element("tr"), button = element("button", name);
      button.type = "button";
      button.setAttribute("aria-label", word("button.why", {motion: name}));
      button.addEventListener("click", () => choose(number));
      const first = element("td"), level = element("td"), free = element("td");
      first.append(button);
      level.append(element("span", "", "chip"));
      const bar = element("span", undefined, "bar");
      bar.append(element("i"));
      free.append(element("span"), bar);
      row.append(first, level, free, element("td"), element("td"));
      return row;
    }));
    const clear = at("clearways");
    clear.hidden = said.mode === "report";
    clear.firstChild.onchange = event => ask({type: "ways", all: event.target.checked});
    const cameras = at("cameras").tBodies[0];
    cameras.replaceChildren(...said.cameras.map(name => {
      const row = element("tr"), button = element("button", name), first = element("td");
      button.type = "button";
      button.setAttribute("aria-label", word("button.depth", {camera: name}));
      button.addEventListener("click", () => ask({type: "depth", camera: name}));
      first.append(button);
      row.append(first, ...Array.from({length: 6}, () => element("td")));
      return row;
    }));
    Plots.begin(at("plots"), [
      {key: "free", title: word("plot.free"), names: said.motions, none: word("plot.none")},
      {key: "cycle", title: word("plot.cycle"), none: word("plot.none")},
      {key: "age", title: word("plot.age"), none: word("plot.none")},
    ]);
  }

  function choose(number) {
    chosen = number;
    mark();
    ask({type: "why", motion: number});
  }

  function mark() {
    [...at("motions").tBodies[0].rows].forEach((row, number) => row.classList.toggle("chosen", number === chosen));
  }

  function moment(said) {
    document.body.classList.remove("waiting", "stop", "decelerate", "inform", "clear", "unknown");
    document.body.classList.add(said.level);
    setText(at("mark"), {stop: "■", decelerate: "▲", inform: "●", clear: "○"}[said.level] ?? "?");
    setText(at("word"), said.word);
    setText(at("sentence"), said.sentence);
    setText(at("detail"), said.detail);
    setText(at("at"), `${hello.site} · ${word("mode." + hello.mode)} · ${said.at}`);
    if (chosen === null) {
      at("why").hidden = !said.why;
      if (said.why) because(said.why);
    }
    const rows = at("motions").tBodies[0].rows;
    said.motions.forEach((one, number) => {
      const cells = rows[number].cells, chip = cells[1].firstChild;
      setText(chip, `${one.mark} ${one.word}`);
      chip.className = "chip " + one.level;
      setText(cells[2].firstChild, one.free);
      cells[2].lastChild.firstChild.style.width = `${100 * one.share}%`;
      setText(cells[3], one.speed);
      setText(cells[4], one.cause);
    });
    const cameras = at("cameras").tBodies[0].rows;
    (said.cameras ?? []).forEach((one, number) => {
      const cells = cameras[number].cells;
      cameras[number].classList.toggle("ill", !one.is_well);
      ["state", "rate", "age", "skew", "valid", "drift"].forEach((key, column) => setText(cells[column + 1], one[key]));
    });
    at("path").hidden = !said.path;
    if (said.path) {
      setText(at("path"), said.path.text);
      at("path").className = said.path.level;
    }
    if (said.thinned !== undefined) setText(at("near"), [hello.near, said.thinned].filter(Boolean).join(" "));
  }

  function why(said) {
    at("why").hidden = false;
    chosen = said.number;
    mark();
    because(said);
    at("why").dataset.final = said.is_final;
  }

  function because(said) {
    setText(at("whysentence"), said.sentence);
    const list = at("changes");
    if ([...list.children].map(one => one.textContent).join("\n") !== said.changes.join("\n"))
      list.replaceChildren(...said.changes.map(text => element("li", text)));
    at("changehead").hidden = said.changes.length === 0;
  }

  function depth(said) {
    const figure = at("depth");
    figure.hidden = false;
    const title = word("head.depth", {camera: said.camera});
    setText(figure.querySelector("figcaption"), title);
    Object.assign(figure.querySelector("img"), {src: said.picture, alt: title});
  }

  function old(text) {
    document.body.classList.toggle("old", text !== null);
    at("old").hidden = text === null;
    if (text !== null) setText(at("old"), text);
  }

  function seconds(value) { return value.toFixed(value < 10 ? 1 : 0).replace(".", hello ? hello.words.decimal : "."); }

  return {at, begin, moment, why, because, depth, old, word, element, setText, seconds, choose};
})();
