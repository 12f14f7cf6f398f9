"use strict";
// reset and hold-to-override: this tab asks the control service itself, so the token is in this tab and nowhere else
const Controls = (() => {
  const EVERY_MS = 60, MOST_WAITING = 4, ANSWERS_MS = 4000, LOOKS_MS = 2000, KEPT_MS = 300000;
  const TOKEN = /^[0-9A-Za-z_-]{32,200}$/;
  const at = Panel.at, word = Panel.word;
  let service = null, token = null, usedAt = 0, isThere = false, isOld = true, held = null, gate = null;

  function begin(said) {
    service = said.service ? `http://127.0.0.1:${said.service}` : null;
    forget(null);
    look();
  }

  // shown while the service answers, and not otherwise
  async function look() {
    let answers = false;
    if (service !== null) {
      try {
        answers = (await fetch(`${service}/health/live`, {...PLAIN, signal: AbortSignal.timeout(ANSWERS_MS)})).ok;
      } catch { answers = false; }
    }
    isThere = answers;
    at("controls").hidden = !isThere;
    if (!isThere && token !== null) forget("controls.gone");
  }

  const PLAIN = {cache: "no-store", credentials: "omit", redirect: "error", referrerPolicy: "no-referrer"};
  const nonce = () => [...crypto.getRandomValues(new Uint8Array(16))].map(one => one.toString(16).padStart(2, "0")).join("");

  // status and answer; status 0: none came
  async function ask(what, signal) {
    usedAt = performance.now();
    const headers = {"Authorization": `Bearer ${token}`, "Content-Type": "application/json"};
    const body = JSON.stringify({nonce: nonce(), time_ms: Date.now()});
    try {
      const answer = await fetch(`${service}/v1/${what}`, {...PLAIN, method: "POST", headers, body, signal});
      return {status: answer.status, said: await answer.json()};
    } catch { return {status: 0, said: {}}; }
  }

  function say(key, values) { Panel.setText(at("controlsaid"), key === null ? "" : word(key, values)); }

  function use() {
    const given = at("token").value.trim();
    at("token").value = "";
    if (!TOKEN.test(given)) { say("controls.no_token"); return; }
    token = given;
    usedAt = performance.now();
    say(null);
    show();
  }

  function forget(key) {
    release(null);
    token = null;
    at("token").value = "";
    say(key);
    show();
  }

  function show() {
    at("nottoken").hidden = token !== null;
    at("withtoken").hidden = token === null;
    for (const id of ["reset", "hold", "use"]) at(id).disabled = isOld;
    at("hold").setAttribute("aria-pressed", held !== null);
  }

  // why nothing was done, in words
  function refused({status, said}) {
    const keys = {401: "controls.wrong", 403: "controls.origin", 409: "controls.clock", 429: "controls.flood", 503: "controls.no_gate", 0: "controls.gone"};
    if (status === 401) forget(null);
    say(keys[status] ?? "controls.other", {text: said.error ?? status});
  }

  async function reset() {
    if (token === null || isOld) return;
    say("controls.asking");
    const answer = await ask("reset", AbortSignal.timeout(ANSWERS_MS));
    if (answer.status !== 200) { refused(answer); return; }
    const {done, gate: now} = answer.said, faults = now.active.map(one => one.text);
    if (done) say("controls.reset_done");
    else if (now.phase === "latched") say("controls.reset_there", {text: faults.join("; ") || word("gate.latched")});
    else say("controls.reset_nothing", {text: word("gate.now", {phase: word(`gate.${now.phase}`)})});
  }

  // a signal each 60 ms while the button is pressed; the gate counts each for 200 ms from when it was sent
  function press() {
    if (held !== null || token === null || isOld || document.hidden) return;
    held = {over: new AbortController(), waiting: 0, isLate: false};
    const mine = held;
    mine.timer = setInterval(() => beat(mine), EVERY_MS);
    beat(mine);
    tell();
    show();
  }

  async function beat(mine) {
    if (held !== mine || mine.waiting >= MOST_WAITING) return;
    mine.waiting += 1;
    const answer = await ask("hold", AbortSignal.any([mine.over.signal, AbortSignal.timeout(ANSWERS_MS)]));
    mine.waiting -= 1;
    if (held !== mine) return;
    if (answer.status !== 200) { release(null); refused(answer); return; }
    mine.isLate = !answer.said.done;
    tell();
  }

  function tell() {
    if (held === null) return;
    if (held.isLate) say("controls.late");
    else if (gate !== null && gate.held) say("controls.holding", {text: gate.held});
    else say("controls.holding_none");
  }

  function release(key) {
    if (held === null) return;
    clearInterval(held.timer);
    held.over.abort();
    held = null;
    say(key);
    show();
  }

  function moment(said) {
    gate = said.gate;
    Panel.setText(at("gatesaid"), gate === null ? "" : gate.text);
    tell();
  }

  // who does not see what is does not reset or hold
  function watch(is) {
    if (is) release("controls.let_go_old");
    if (token !== null && held === null && performance.now() - usedAt > KEPT_MS) forget("controls.forgotten");
    if (is !== isOld) { isOld = is; show(); }
  }

  const letGo = () => release("controls.let_go"), keys = ["Enter", " "];
  at("use").addEventListener("click", use);
  at("token").addEventListener("keydown", event => { if (event.key === "Enter") use(); });
  at("forget").addEventListener("click", () => forget("controls.forgotten"));
  at("reset").addEventListener("click", reset);
  at("hold").addEventListener("pointerdown", event => {
    if (event.button !== 0) return;
    at("hold").setPointerCapture(event.pointerId);
    press();
  });
  for (const kind of ["pointerup", "pointercancel", "lostpointercapture", "blur"]) at("hold").addEventListener(kind, letGo);
  at("hold").addEventListener("contextmenu", event => event.preventDefault());
  at("hold").addEventListener("keydown", event => {
    if (!keys.includes(event.key)) return;
    event.preventDefault();
    if (!event.repeat) press();
  });
  at("hold").addEventListener("keyup", event => { if (keys.includes(event.key)) letGo(); });
  window.addEventListener("blur", letGo);
  window.addEventListener("pagehide", () => forget(null));
  document.addEventListener("visibilitychange", () => { if (document.hidden) letGo(); });
  setInterval(look, LOOKS_MS);

  return {begin, moment, watch};
})();
