"use strict";
// talks with the page's process: what it says is shown, and what is old is said to be old
(() => {
  const OLD_S = 1.0, AGAIN_MS = 1000, DRAWS_MS = 33, SLOWEST_MS = 100, WAITING_MS = 400;
  const token = [...crypto.getRandomValues(new Uint8Array(16))].map(one => one.toString(16).padStart(2, "0")).join("");
  let socket = null, hello = null, heard = null, age = 0, isOpen = false, isEnded = false;

  const now = () => performance.now() / 1000;
  const ask = question => { if (isOpen) socket.send(JSON.stringify(question)); };

  function connect() {
    socket = new WebSocket(`ws://${location.host}/text`);
    socket.onopen = () => { isOpen = true; ask({type: "scene", token}); };
    socket.onclose = () => { isOpen = false; setTimeout(connect, AGAIN_MS); };
    socket.onmessage = event => take(JSON.parse(event.data));
  }

  function take(said) {
    if (said.type === "hello") {
      hello = said;
      isEnded = false;
      Panel.begin(said, ask);
      if (said.mode === "replay") Slider.begin(said, ask);
      Controls.begin(said);
    } else if (said.type === "moment") {
      heard = now();
      age = said.age_s;
      Panel.moment(said);
      Controls.moment(said);
      const time = hello.mode === "replay" ? said.sequence_s : heard;
      Plots.add("free", time, said.motions.map(one => one.brakes));
      Plots.add("cycle", time, [said.cycle_ms]);
      Plots.add("age", time, [said.age_ms]);
      if (said.index !== undefined) Slider.moment(said);
    } else if (said.type === "why") Panel.why(said);
    else if (said.type === "depth") Panel.depth(said);
    else if (said.type === "trouble") { Panel.at("note").hidden = false; Panel.setText(Panel.at("note"), said.text); }
    else if (said.type === "ended") isEnded = true;
    else if (said.type === "play") Slider.playing(said.is_playing);
    watch();
  }

  // the last good picture is never shown as if it were now
  function watch() {
    if (!hello) return;
    const seconds = heard === null ? 0 : now() - heard + age, values = {age: Panel.seconds(seconds)};
    let old = null;
    if (isEnded) old = Panel.word("ended");
    else if (!isOpen) old = Panel.word("gone", values);
    else if (hello.mode === "live" && heard !== null && seconds > OLD_S) old = Panel.word("old", values);
    Panel.old(old);
    Controls.watch(old !== null || heard === null);
  }

  function hasWebGL() {
    try {
      const canvas = document.createElement("canvas");
      return Boolean(canvas.getContext("webgl2") || canvas.getContext("webgl"));
    } catch { return false; }
  }

  const NO_WEBGL = document.body.dataset.noWebgl;

  // the room is drawn as often as joints come, and less often where drawing takes long: a browser that draws by software
  // on the monitor's own computer leaves it its processor
  function calm(view) {
    const draw = view.requestAnimationFrame.bind(view), timers = new Map();
    let took = 0, number = 0;
    view.requestAnimationFrame = callback => {
      const id = ++number, isWaiting = document.body.classList.contains("waiting");
      const pause = isWaiting ? WAITING_MS : Math.max(DRAWS_MS - took, Math.min(took, SLOWEST_MS));
      timers.set(id, setTimeout(() => {
        const asked = performance.now();
        timers.set(id, null);
        draw(time => {
          if (!timers.delete(id)) return;
          callback(time);
          took = performance.now() - asked;
        });
      }, pause));
      return id;
    };
    view.cancelAnimationFrame = id => { clearTimeout(timers.get(id)); timers.delete(id); };
  }

  function openScene() {
    const place = Panel.at("scene");
    if (!hasWebGL()) { Panel.setText(Panel.at("noscene"), NO_WEBGL); place.dataset.drawn = "no"; return; }
    const frame = document.createElement("iframe");
    frame.title = place.getAttribute("aria-label");
    frame.src = `/scene/${token}`;
    frame.onload = () => {
      const style = frame.contentDocument.createElement("style");
      style.textContent = "body * { visibility: hidden !important; } canvas { visibility: visible !important; }";
      frame.contentDocument.head.append(style);
      calm(frame.contentWindow);
      frame.contentDocument.documentElement.lang = document.documentElement.lang;
      place.dataset.drawn = "yes";
    };
    place.append(frame);
  }

  connect();
  openScene();
  setInterval(watch, 100);
  setInterval(Plots.draw, 250);
})();
