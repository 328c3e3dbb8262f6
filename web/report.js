'use strict';
// Draws a report's clouds on two canvases, orthographic, with plain 2D calls. Reads the JSON of the
// element #data; without it, or without canvas, the static pictures stay.
(() => {
  const data = JSON.parse(document.getElementById('data').textContent);
  const figure = document.getElementById('figure');
  if (!figure || !data.query) return;

  // ---- numbers ---------------------------------------------------------------------------------
  // Points travel as little-endian int16, three each: position = offset + scale * value.
  const decode = (cloud) => {
    const text = atob(cloud.xyz);
    const bytes = new Uint8Array(text.length);
    for (let i = 0; i < text.length; ++i) bytes[i] = text.charCodeAt(i);
    const view = new DataView(bytes.buffer);
    const out = new Float64Array(bytes.length / 2);
    for (let i = 0; i < out.length; ++i) {
      out[i] = cloud.offset[i % 3] + cloud.scale * view.getInt16(2 * i, true);
    }
    return out;
  };
  const apply = (T, p) => [0, 1, 2].map(
    (r) => T[4 * r] * p[0] + T[4 * r + 1] * p[1] + T[4 * r + 2] * p[2] + T[4 * r + 3]);
  const moved = (T, points) => {
    const out = new Float64Array(points.length);
    for (let i = 0; i < points.length; i += 3) {
      const q = apply(T, [points[i], points[i + 1], points[i + 2]]);
      out[i] = q[0]; out[i + 1] = q[1]; out[i + 2] = q[2];
    }
    return out;
  };
  const times = (A, B) => {
    const out = [];
    for (let r = 0; r < 4; ++r) {
      for (let c = 0; c < 4; ++c) {
        let sum = 0;
        for (let k = 0; k < 4; ++k) sum += A[4 * r + k] * B[4 * k + c];
        out.push(sum);
      }
    }
    return out;
  };
  const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
  const cross = (a, b) =>
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
  const unit = (a) => { const n = Math.hypot(...a) || 1; return a.map((v) => v / n); };
  const add = (a, b, s) => [a[0] + s * b[0], a[1] + s * b[1], a[2] + s * b[2]];

  const sensorQuery = decode(data.query);
  const identity = [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1];

  // ---- what is drawn: one world a candidate ------------------------------------------------------
  const makeWorld = (candidate) => {
    const T = candidate ? candidate.T_scene_sensor : identity;
    const world = {
      T,
      up: unit((candidate && candidate.up) || data.up || [0, 0, 1]),
      place: candidate && candidate.place ? decode(candidate.place) : new Float64Array(0),
      query: moved(T, sensorQuery),
      sensor: apply(T, data.viewpoint),
      spacing: candidate ? candidate.spacing_m : 0,
      frames: [{ name: 'sensor', T }],
      pairs: candidate && candidate.pairs ? candidate.pairs : { inliers: [], rejected: [] },
    };
    if (candidate) {
      world.frames.push({ name: 'landmark', T: times(candidate.T_icp, candidate.T_scene_landmark) });
      world.frames.push({ name: 'scene', T: identity });
    }
    const low = [Infinity, Infinity, Infinity];
    const high = [-Infinity, -Infinity, -Infinity];
    const take = (p) => { for (let k = 0; k < 3; ++k) { low[k] = Math.min(low[k], p[k]); high[k] = Math.max(high[k], p[k]); } };
    for (const points of [world.place, world.query]) {
      for (let i = 0; i < points.length; i += 3) take([points[i], points[i + 1], points[i + 2]]);
    }
    take(world.sensor);
    world.centre = [0, 1, 2].map((k) => 0.5 * (low[k] + high[k]));
    world.radius = 0.5 * Math.hypot(...[0, 1, 2].map((k) => high[k] - low[k])) || 1;
    // What points right in the two views.
    world.right = candidate ? [candidate.above_right, candidate.side_right] : [data.above_right, data.side_right];
    const heights = [];
    for (let i = 0; i < world.place.length; i += 3) {
      heights.push(dot([world.place[i], world.place[i + 1], world.place[i + 2]], world.up));
    }
    const sorted = Float64Array.from(heights).sort();
    world.heights = heights;
    world.floor = sorted.length ? sorted[Math.floor(0.02 * sorted.length)] : 0;
    world.ceiling = sorted.length ? sorted[Math.floor(0.98 * sorted.length)] : 1;
    world.cut = candidate && candidate.cut_m !== null ? candidate.cut_m : Infinity;
    return world;
  };
  const worlds = data.candidates.length ? data.candidates.map(makeWorld) : [makeWorld(null)];
  let world = worlds[0];

  // ---- one canvas -------------------------------------------------------------------------------
  const shown = { place: true, query: true, inliers: true, rejected: false, frustum: true, frames: true, cut: true };
  const colours = () => {
    const style = getComputedStyle(document.documentElement);
    const colour = (name) => style.getPropertyValue('--' + name).trim();
    const out = {};
    for (const name of ['ink', 'paper', 'soft', 'place-low', 'place-high', 'query', 'inlier', 'rejected', 'frustum', 'landmark']) out[name] = colour(name);
    return out;
  };
  const mix = (a, b, share) => {
    const part = (text, k) => parseInt(text.slice(1 + 2 * k, 3 + 2 * k), 16);
    return 'rgb(' + [0, 1, 2].map((k) => Math.round(part(a, k) + share * (part(b, k) - part(a, k)))).join(',') + ')';
  };

  class View {
    constructor(canvas, pitch, fromAbove) {
      this.canvas = canvas;
      this.startPitch = pitch;
      this.fromAbove = fromAbove;
      this.reset();
      this.listen();
    }
    reset() {
      this.yaw = 0; this.pitch = this.startPitch; this.zoom = 1; this.pan = [0, 0];
      this.orbited = false;
    }
    axes() {
      const c = Math.cos(this.yaw), s = Math.sin(this.yaw);
      const base = world.right[this.fromAbove ? 0 : 1];
      const beyond = cross(world.up, base);
      const right = add(base.map((v) => v * c), beyond, s);
      const ahead = add(beyond.map((v) => v * c), base, -s);
      const upward = add(world.up.map((v) => v * Math.cos(this.pitch)), ahead, Math.sin(this.pitch));
      return { right, upward };
    }
    draw() {
      const canvas = this.canvas;
      const ratio = window.devicePixelRatio || 1;
      const wide = canvas.clientWidth, high = canvas.clientHeight;
      if (!wide || !high) return;
      canvas.width = Math.round(wide * ratio); canvas.height = Math.round(high * ratio);
      const g = canvas.getContext('2d');
      g.scale(ratio, ratio);
      const { right, upward } = this.axes();
      this.fit(wide, high, right, upward);
      const m = this.metre * this.zoom;
      const c = this.middle;
      const at = (x, y, z) => [
        wide / 2 + this.pan[0] + m * ((x - c[0]) * right[0] + (y - c[1]) * right[1] + (z - c[2]) * right[2]),
        high / 2 + this.pan[1] - m * ((x - c[0]) * upward[0] + (y - c[1]) * upward[1] + (z - c[2]) * upward[2])];
      const paint = colours();
      const cut = this.fromAbove && shown.cut && !this.orbited ? world.cut : Infinity;
      if (shown.place) this.drawPlace(g, at, paint, cut, m);
      if (shown.query) this.drawCloud(g, at, world.query, paint.query, cut);
      if (shown.rejected) this.drawPairs(g, at, world.pairs.rejected, paint.rejected, true);
      if (shown.inliers) this.drawPairs(g, at, world.pairs.inliers, paint.inlier, false);
      if (shown.frustum) this.drawFrustum(g, at, paint);
      if (shown.frames) this.drawFrames(g, at, paint, wide, high);
      this.drawScale(g, paint, wide, high, m);
    }
    // The scale at which everything shown fits, in the starting direction; orbiting keeps it.
    fit(wide, high, right, upward) {
      if (this.orbited && this.metre) return;
      let box = [Infinity, -Infinity, Infinity, -Infinity];
      const take = (points) => {
        for (let i = 0; i < points.length; i += 3) {
          const p = [points[i], points[i + 1], points[i + 2]];
          const x = dot(p, right), y = dot(p, upward);
          box = [Math.min(box[0], x), Math.max(box[1], x), Math.min(box[2], y), Math.max(box[3], y)];
        }
      };
      take(world.place); take(world.query); take(world.sensor);
      this.metre = Math.min(wide / (box[1] - box[0] || 1), high / (box[3] - box[2] || 1)) * 0.9;
      const x = 0.5 * (box[0] + box[1]), y = 0.5 * (box[2] + box[3]);
      const deep = cross(right, upward);
      this.middle = add(add(deep.map((v) => v * dot(world.centre, deep)), right, x), upward, y);
    }
    drawPlace(g, at, paint, cut, m) {
      const size = Math.max(1.3, Math.min(5, 0.6 * world.spacing * m));
      const steps = 8;
      const span = world.ceiling - world.floor || 1;
      const bins = Array.from({ length: steps }, () => []);
      for (let i = 0; i < world.heights.length; ++i) {
        if (world.heights[i] > cut) continue;
        const share = (world.heights[i] - world.floor) / (Math.min(cut, world.ceiling) - world.floor || span);
        bins[Math.max(0, Math.min(steps - 1, Math.floor(share * steps)))].push(3 * i);
      }
      bins.forEach((bin, k) => {
        g.fillStyle = mix(paint['place-low'], paint['place-high'], k / (steps - 1));
        for (const i of bin) {
          const p = at(world.place[i], world.place[i + 1], world.place[i + 2]);
          g.fillRect(p[0] - size / 2, p[1] - size / 2, size, size);
        }
      });
    }
    drawCloud(g, at, points, colour, cut) {
      g.fillStyle = colour;
      for (let i = 0; i < points.length; i += 3) {
        if (cut < Infinity && dot([points[i], points[i + 1], points[i + 2]], world.up) > cut) continue;
        const p = at(points[i], points[i + 1], points[i + 2]);
        g.fillRect(p[0] - 0.9, p[1] - 0.9, 1.8, 1.8);
      }
    }
    drawPairs(g, at, pairs, colour, dashed) {
      g.strokeStyle = colour; g.fillStyle = colour; g.lineWidth = 1;
      g.globalAlpha = dashed ? 0.55 : 1;
      g.setLineDash(dashed ? [5, 3] : []);
      for (const pair of pairs) {
        const a = at(...apply(world.T, pair.slice(0, 3)));
        const b = at(...pair.slice(3));
        g.beginPath(); g.moveTo(...a); g.lineTo(...b); g.stroke();
        if (!dashed) { g.beginPath(); g.arc(a[0], a[1], 2.2, 0, 7); g.fill(); g.strokeRect(b[0] - 2.2, b[1] - 2.2, 4.4, 4.4); }
      }
      g.setLineDash([]); g.globalAlpha = 1;
    }
    label(g, paint, text, x, y, colour) {
      g.font = '600 13px system-ui, "DejaVu Sans", sans-serif';
      g.lineWidth = 4; g.lineJoin = 'round'; g.strokeStyle = paint.paper; g.fillStyle = colour;
      g.strokeText(text, x, y); g.fillText(text, x, y);
    }
    drawFrustum(g, at, paint) {
      g.strokeStyle = paint.frustum; g.lineWidth = 2;
      for (const line of data.frustum) {
        g.beginPath();
        line.forEach((p, i) => { const q = at(...apply(world.T, p)); if (i) g.lineTo(...q); else g.moveTo(...q); });
        g.stroke();
      }
      const q = at(...world.sensor);
      g.fillStyle = paint.frustum; g.beginPath(); g.arc(q[0], q[1], 4, 0, 7); g.fill();
    }
    drawFrames(g, at, paint, wide, high) {
      const length = 0.16 * world.radius;
      const names = { sensor: paint.frustum, landmark: paint.landmark, scene: paint.ink };
      for (const frame of world.frames) {
        const origin = [frame.T[3], frame.T[7], frame.T[11]];
        const o = at(...origin);
        if (o[0] < -20 || o[1] < -20 || o[0] > wide + 20 || o[1] > high + 20) continue;
        [[paint.rejected, 'x'], [paint.inlier, 'y'], [paint.query, 'z']].forEach(([colour, name], k) => {
          const axis = unit([frame.T[k], frame.T[4 + k], frame.T[8 + k]]);
          const e = at(...add(origin, axis, length));
          if (Math.hypot(e[0] - o[0], e[1] - o[1]) < 4) return;
          for (const [stroke, width] of [[paint.paper, 4], [colour, 2]]) {
            g.strokeStyle = stroke; g.lineWidth = width;
            g.beginPath(); g.moveTo(...o); g.lineTo(...e); g.stroke();
          }
          this.label(g, paint, name, e[0] + 2, e[1] - 2, colour);
        });
        this.label(g, paint, frame.name, Math.max(4, Math.min(wide - 64, o[0] + 6)), Math.max(14, Math.min(high - 6, o[1] + 16)), names[frame.name]);
      }
    }
    // A bar of 1, 2 or 5 times a power of ten metres.
    drawScale(g, paint, wide, high, m) {
      const want = 0.22 * wide / m;
      const power = 10 ** Math.floor(Math.log10(want));
      const metres = [5, 2, 1].map((k) => k * power).find((v) => v <= want) || power;
      const y = high - 14;
      g.strokeStyle = paint.ink; g.lineWidth = 2;
      g.beginPath(); g.moveTo(14, y - 4); g.lineTo(14, y); g.lineTo(14 + metres * m, y); g.lineTo(14 + metres * m, y - 4); g.stroke();
      const text = metres >= 1 ? metres + ' m' : Math.round(metres * 100) + ' cm';
      this.label(g, paint, text, 14, y - 7, paint.ink);
    }
    listen() {
      const canvas = this.canvas;
      let from = null;
      canvas.addEventListener('pointerdown', (e) => { from = [e.clientX, e.clientY]; canvas.setPointerCapture(e.pointerId); });
      canvas.addEventListener('pointerup', () => { from = null; });
      canvas.addEventListener('pointermove', (e) => {
        if (!from) return;
        const dx = e.clientX - from[0], dy = e.clientY - from[1];
        from = [e.clientX, e.clientY];
        if (e.shiftKey || e.buttons === 4) { this.pan[0] += dx; this.pan[1] += dy; this.draw(); } else this.turn(-dx * 0.008, dy * 0.008);
      });
      canvas.addEventListener('wheel', (e) => { e.preventDefault(); this.scale(Math.exp(-e.deltaY * 0.001)); }, { passive: false });
      canvas.addEventListener('dblclick', () => { this.reset(); this.draw(); });
      canvas.addEventListener('keydown', (e) => {
        const act = {
          ArrowLeft: () => this.turn(-0.1, 0), ArrowRight: () => this.turn(0.1, 0),
          ArrowUp: () => this.turn(0, 0.1), ArrowDown: () => this.turn(0, -0.1),
          '+': () => this.scale(1.2), '-': () => this.scale(1 / 1.2),
          Home: () => { this.reset(); this.draw(); },
        }[e.key];
        if (act) { e.preventDefault(); act(); }
      });
    }
    turn(yaw, pitch) {
      this.orbited = true;
      this.yaw += yaw;
      this.pitch = Math.max(-Math.PI / 2, Math.min(Math.PI / 2, this.pitch + pitch));
      this.draw();
    }
    scale(by) {
      this.zoom = Math.max(0.1, Math.min(200, this.zoom * by));
      this.pan = this.pan.map((v) => v * by);
      this.draw();
    }
  }

  // ---- the page ---------------------------------------------------------------------------------
  figure.classList.add('drawn');
  const views = [
    new View(document.getElementById('above'), Math.PI / 2, true),
    new View(document.getElementById('side'), 0, false),
  ];
  const drawAll = () => views.forEach((view) => view.draw());
  for (const box of figure.querySelectorAll('input[data-show]')) {
    box.checked = shown[box.dataset.show];
    box.addEventListener('change', () => { shown[box.dataset.show] = box.checked; drawAll(); });
  }
  const tabs = figure.querySelectorAll('button[data-candidate]');
  for (const tab of tabs) {
    tab.addEventListener('click', () => {
      world = worlds[Number(tab.dataset.candidate)];
      for (const other of tabs) other.setAttribute('aria-pressed', String(other === tab));
      views.forEach((view) => { view.reset(); view.metre = 0; });
      drawAll();
    });
  }
  const again = figure.querySelector('button[data-reset]');
  if (again) again.addEventListener('click', () => { views.forEach((view) => view.reset()); drawAll(); });
  new ResizeObserver(drawAll).observe(figure);
  window.matchMedia('(prefers-color-scheme: dark)').addEventListener('change', drawAll);
  drawAll();
  figure.dataset.drawn = 'yes';
})();
