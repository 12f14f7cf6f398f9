"use strict";
// the report of a stop: all that it shows is in this file
(async () => {
  const KINDS = {float32: Float32Array, int16: Int16Array, uint16: Uint16Array, uint32: Uint32Array};

  async function unpacked() {
    const text = atob(document.getElementById("data").textContent.trim());
    const packed = Uint8Array.from(text, one => one.charCodeAt(0));
    const stream = new Blob([packed]).stream().pipeThrough(new DecompressionStream("deflate"));
    const whole = await new Response(stream).arrayBuffer(), length = new DataView(whole).getUint32(0, true);
    const values = JSON.parse(new TextDecoder().decode(new Uint8Array(whole, 4, length)));
    const array = number => { const [kind, at, size] = values.arrays[number]; return new KINDS[kind](whole, 4 + length + at, size); };
    return {values, array};
  }

  const {values, array} = await unpacked();
  const {moments, colours, grid} = values;
  let index = values.about, timer = null;

  const ask = question => {
    if (question.type === "seek") { pause(); show(question.index); }
    else if (question.type === "step") { pause(); show(Math.min(Math.max(index + question.by, 0), moments.length - 1)); }
    else if (question.type === "play") play();
    else if (question.type === "pause") pause();
    else if (question.type === "why") why(question.motion);
    else if (question.type === "depth") {
      const found = moments[values.about].depth.find(one => one.camera === question.camera);
      if (found) Panel.depth(found);
    }
  };

  const drawnAt = number => { while (number > 0 && !("near" in moments[number])) number--; return moments[number]; };

  function why(number) {
    const moment = moments[index], drawn = drawnAt(index);
    const known = drawn === moment ? drawn.whys.find(one => one.number === number) : undefined;
    const row = moment.motions[number];
    const said = known ?? (moment.why && moment.motion === number ? {number, ...moment.why} : {number, sentence: `${row.name}: ${row.word}, ${row.free}, ${row.cause}.`, changes: []});
    Panel.why({...said, is_final: true});
    if (said.place) Viewer.look(said.place, 2);
  }

  function voxels(number) {
    const steps = array(number), points = new Float32Array(3 * steps.length);
    let at = 0;
    steps.forEach((step, n) => {
      at += step;
      const k = at % grid.shape[2], j = Math.floor(at / grid.shape[2]) % grid.shape[1], i = Math.floor(at / (grid.shape[2] * grid.shape[1]));
      [i, j, k].forEach((cell, axis) => { points[3 * n + axis] = grid.origin[axis] + (cell + 0.5) * grid.voxel; });
    });
    return points;
  }

  function show(number) {
    index = number;
    const moment = moments[index], drawn = drawnAt(index);
    Panel.moment(moment);
    if (moment.why) Panel.because(drawn === moment && drawn.whys.find(one => one.number === moment.motion) || moment.why);
    Slider.moment({...moment, index});
    Plots.add("free", moment.wall_s, moment.motions.map(one => one.brakes));
    Plots.add("cycle", moment.wall_s, [moment.cycle_ms]);
    Plots.add("age", moment.wall_s, [moment.age_ms]);
    Plots.draw();
    if (!hasScene) return;
    Viewer.placeBodies(moment.poses === null ? null : array(moment.poses));
    const clouds = [];
    if (drawn.near) for (const [kind, at] of Object.entries(drawn.near)) clouds.push({points: voxels(at), colour: colours[kind], size: grid.voxel});
    for (const [level, at] of drawn.ways ?? []) clouds.push({points: Float32Array.from(array(at), value => value / 100), colour: colours[level], size: 0.014});
    clouds.push({points: Float32Array.from((drawn.contacts ?? []).flat()), colour: colours.contact, size: 0.06, above: true});
    Viewer.setClouds(clouds);
    Viewer.draw();
  }

  function play() {
    if (index === moments.length - 1) index = 0;
    Slider.playing(true);
    const begun = performance.now() / 1000 - moments[index].wall_s;
    timer = setInterval(() => {
      let next = index;
      while (next + 1 < moments.length && performance.now() / 1000 - begun >= moments[next + 1].wall_s) next++;
      if (next !== index) show(next);
      if (index === moments.length - 1) pause();
    }, 40);
  }

  function pause() { clearInterval(timer); timer = null; Slider.playing(false); }

  document.getElementById("facts").replaceChildren(...values.facts.map(text => Panel.element("li", text)));
  Panel.setText(document.getElementById("sitefile"), values.site_file);
  Panel.begin(values.hello, ask);
  Slider.begin(values.hello, ask);
  const place = Panel.at("scene"), hasScene = Viewer.begin(place);
  if (!hasScene) Panel.setText(Panel.at("noscene"), document.body.dataset.noWebgl);
  else {
    Panel.at("noscene").hidden = true;
    values.links.forEach(number => Viewer.addBody(array(number), colours.machine));
    const upper = grid.origin.map((value, axis) => value + grid.shape[axis] * grid.voxel), ends = [];
    for (let n = 0; n < 8; n++) for (let axis = 0; axis < 3; axis++) if (!(n >> axis & 1))
      for (const corner of [n, n | 1 << axis]) ends.push(...[0, 1, 2].map(one => corner >> one & 1 ? upper[one] : grid.origin[one]));
    Viewer.addLines(Float32Array.from(ends), colours.box);
    values.frusta.forEach((corners, number) => {
      const well = moments[values.about].cameras[number].is_well, rim = [1, 2, 3, 4];
      Viewer.addLines(Float32Array.from(rim.flatMap((one, n) => [...corners[0], ...corners[one], ...corners[one], ...corners[rim[(n + 1) % 4]]])), well ? colours.camera : colours.ill);
    });
    const middle = grid.origin.map((value, axis) => (value + upper[axis]) / 2);
    Viewer.look(middle, 1.15 * Math.hypot(...upper.map((value, axis) => value - grid.origin[axis])) * 0.75);
  }
  place.dataset.drawn = hasScene ? "yes" : "no";
  show(index);
})();
