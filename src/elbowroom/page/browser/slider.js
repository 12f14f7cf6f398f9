"use strict";
// time within a recording: slider, stops as marks, play and step
const Slider = (() => {
  const at = Panel.at;
  let ask = () => {}, count = 1, isPlaying = false, isHeld = false;

  function begin(said, asks) {
    ask = asks;
    count = said.count;
    at("time").hidden = false;
    const slider = at("slider");
    slider.max = count - 1;
    slider.oninput = () => { isHeld = true; ask({type: "seek", index: Number(slider.value)}); };
    slider.onchange = () => { isHeld = false; };
    at("back").onclick = () => ask({type: "step", by: -1});
    at("forth").onclick = () => ask({type: "step", by: 1});
    at("play").onclick = () => ask({type: isPlaying ? "pause" : "play"});
    at("note").hidden = !said.note;
    Panel.setText(at("note"), said.note ?? "");
    const stops = said.stops.map((one, number) => {
      const button = Panel.element("button", `${one.time} ${one.text}`);
      button.type = "button";
      button.setAttribute("aria-label", Panel.word("button.stop", {number: number + 1, ...one}));
      button.onclick = () => ask({type: "seek", index: one.index});
      return button;
    });
    at("stops").replaceChildren(...(stops.length ? stops : [Panel.element("span", Panel.word("no_stops"))]));
    at("marks").replaceChildren(...said.stops.map(one => {
      const mark = Panel.element("i");
      mark.style.left = `${100 * one.index / Math.max(1, count - 1)}%`;
      return mark;
    }));
  }

  function moment(said) {
    if (!isHeld) at("slider").value = said.index;
    at("slider").setAttribute("aria-valuetext", said.at);
  }

  function playing(is) {
    isPlaying = is;
    Panel.setText(at("play"), Panel.word(is ? "button.pause" : "button.play"));
  }

  return {begin, moment, playing};
})();
