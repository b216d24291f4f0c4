// Turns a reconstruction with the mouse: orthographic, drawn on a 2-D canvas so that it needs neither WebGL nor a network.
"use strict";
(function () {
  const root = document.getElementById("scene");
  if (!root) return;
  const data = JSON.parse(document.getElementById("scene-data").textContent);
  const canvas = root.querySelector("canvas");
  const pen = canvas.getContext("2d");
  const slider = root.querySelector("input[type=range]");
  const caption = root.querySelector(".scene-caption");
  const layers = Object.fromEntries([...root.querySelectorAll("[data-layer]")].map((box) => [box.dataset.layer, box]));

  const INK = "#23262b", GRID = "#e3e1dc", MISSING = "#d0584e", COVERED = "#ccd5de", CLOUD = "#525b66";
  const KIND = { first: "#23262b", nbv: "#2c6cb0", recovery: "#d97b16" };
  const KIND_NAME = { first: "first view", nbv: "next best view", recovery: "recovery view" };

  const bytes = (text) => Uint8Array.from(atob(text), (c) => c.charCodeAt(0));
  const counts = (text) => new Int16Array(bytes(text).buffer);
  const metres = (text) => Float32Array.from(counts(text), (n) => n * data.unit);
  const cloud = { at: metres(data.cloud.at), acquisition: counts(data.cloud.acquisition) };
  const surface = { at: metres(data.surface.at) };
  const views = data.views.map((view) => ({
    ...view, camera: metres(view.camera), ellipsoids: metres(view.ellipsoids), regions: metres(view.regions),
    covered: bytes(view.covered), // a bit a surface point, the highest of a byte first
  }));

  const at = (array, k) => [array[3 * k], array[3 * k + 1], array[3 * k + 2]];

  // What the picture turns about: the middle of the reference surface (of the cloud where there is none).
  const about = surface.at.length ? surface.at : cloud.at;
  const low = [Infinity, Infinity, Infinity], high = [-Infinity, -Infinity, -Infinity];
  for (let k = 0; k < about.length; k++) {
    low[k % 3] = Math.min(low[k % 3], about[k]);
    high[k % 3] = Math.max(high[k % 3], about[k]);
  }
  const centre = about.length ? low.map((v, k) => (v + high[k]) / 2) : [0, 0, 0];
  const size = about.length ? Math.hypot(...high.map((v, k) => v - low[k])) : 0.2;
  const reach = Math.max(0, ...views.map((view) => Math.hypot(...at(view.camera, 0).map((v, k) => v - centre[k])))) ;
  const start = { yaw: -0.9, pitch: 0.45, zoom: 1.25 };
  let { yaw, pitch, zoom } = start;
  let basis = null, scale = 1, width = 0, height = 0;

  function prepare() {
    const ratio = window.devicePixelRatio || 1;
    width = canvas.clientWidth;
    height = canvas.clientHeight;
    canvas.width = Math.round(width * ratio);
    canvas.height = Math.round(height * ratio);
    pen.setTransform(ratio, 0, 0, ratio, 0, 0);
    const cy = Math.cos(yaw), sy = Math.sin(yaw), cp = Math.cos(pitch), sp = Math.sin(pitch);
    basis = { right: [-sy, cy, 0], up: [-sp * cy, -sp * sy, cp], towards: [cp * cy, cp * sy, sp] };
    scale = (zoom * Math.min(width, 1.4 * height)) / (size + 1.1 * reach);
  }
  const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
  const flat = (p) => {
    const q = [p[0] - centre[0], p[1] - centre[1], p[2] - centre[2]];
    return [width / 2 + scale * dot(q, basis.right), height / 2 - scale * dot(q, basis.up), dot(q, basis.towards)];
  };
  function polyline(points, close) {
    pen.beginPath();
    points.forEach(([x, y], k) => (k ? pen.lineTo(x, y) : pen.moveTo(x, y)));
    if (close) pen.closePath();
  }

  function drawTable() {
    const cell = 0.05, n = Math.ceil((0.75 * size) / cell);
    pen.strokeStyle = GRID;
    pen.lineWidth = 1;
    for (let k = -n; k <= n; k++) {
      polyline([flat([k * cell, -n * cell, 0]), flat([k * cell, n * cell, 0])]);
      pen.stroke();
      polyline([flat([-n * cell, k * cell, 0]), flat([n * cell, k * cell, 0])]);
      pen.stroke();
    }
  }

  // Points of all sets together; what lies behind nearer points is left out, so that the part looks solid.
  const CELL = 6, BEHIND = 0.012;
  function drawPoints(sets) {
    const columns = Math.ceil(width / CELL), front = new Float32Array(columns * Math.ceil(height / CELL)).fill(-Infinity);
    const points = [];
    for (const { set, colour, side } of sets) {
      for (let k = 0; k < set.at.length / 3; k++) {
        const paint = colour(k);
        if (!paint) continue;
        const [x, y, depth] = flat(at(set.at, k));
        if (x < 0 || y < 0 || x >= width || y >= height) continue;
        const cell = Math.floor(y / CELL) * columns + Math.floor(x / CELL);
        front[cell] = Math.max(front[cell], depth);
        points.push([x, y, depth, paint, cell, side]);
      }
    }
    const grow = Math.max(0.8, Math.min(2, Math.sqrt(zoom / start.zoom)));
    for (const [x, y, depth, paint, cell, plain] of points) {
      const side = plain * grow;
      if (depth < front[cell] - BEHIND) continue;
      pen.globalAlpha = 0.6 + 0.4 * Math.min(1, Math.max(0, depth / size + 0.5)); // nearer is stronger
      pen.fillStyle = paint;
      pen.fillRect(x - side / 2, y - side / 2, side, side);
    }
    pen.globalAlpha = 1;
  }

  function drawEllipsoids(view) {
    const list = view.frontier.map((isFrontier, k) => ({ k, isFrontier, place: flat(at(view.ellipsoids, 4 * k)) }));
    list.sort((a, b) => a.place[2] - b.place[2]);
    for (const { k, isFrontier, place } of list) {
      if (!layers[isFrontier ? "frontier" : "occupied"].checked) continue;
      // Orthographic shadow of centre + M u, |u| = 1: the ellipse with matrix (P M)(P M)^T.
      let a = 0, b = 0, c = 0;
      for (let j = 1; j <= 3; j++) {
        const axis = at(view.ellipsoids, 4 * k + j);
        const x = scale * dot(axis, basis.right), y = -scale * dot(axis, basis.up);
        a += x * x; b += x * y; c += y * y;
      }
      const mean = (a + c) / 2, spread = Math.hypot((a - c) / 2, b);
      pen.beginPath();
      pen.ellipse(place[0], place[1], Math.sqrt(mean + spread), Math.sqrt(Math.max(mean - spread, 0)), 0.5 * Math.atan2(2 * b, a - c), 0, 2 * Math.PI);
      pen.fillStyle = isFrontier ? "rgba(31,140,120,0.06)" : "rgba(70,80,95,0.05)";
      pen.strokeStyle = isFrontier ? "rgba(31,140,120,0.75)" : "rgba(70,80,95,0.45)";
      pen.lineWidth = 1;
      pen.fill();
      pen.stroke();
    }
  }

  const EDGES = [[0, 1], [0, 2], [0, 4], [1, 3], [1, 5], [2, 3], [2, 6], [3, 7], [4, 5], [4, 6], [5, 7], [6, 7]];
  function drawRegions(view) {
    pen.strokeStyle = KIND.recovery;
    for (let r = 0; r < view.regions.length / 24; r++) {
      pen.lineWidth = r === 0 ? 2 : 1;
      for (const [i, j] of EDGES) {
        polyline([flat(at(view.regions, 8 * r + i)), flat(at(view.regions, 8 * r + j))]);
        pen.stroke();
      }
    }
  }

  function drawCameras(now) {
    views.forEach((view, k) => {
      if (k > now) return;
      const [eye, ...corners] = [0, 1, 2, 3, 4].map((c) => flat(at(view.camera, c)));
      pen.strokeStyle = KIND[view.kind];
      pen.globalAlpha = k === now ? 1 : 0.45;
      pen.lineWidth = k === now ? 2 : 1;
      polyline(corners, true);
      pen.stroke();
      for (const corner of corners) {
        polyline([eye, corner]);
        pen.stroke();
      }
      pen.fillStyle = KIND[view.kind];
      pen.font = (k === now ? "600 13px " : "11px ") + "system-ui, sans-serif";
      pen.fillText(String(k + 1), eye[0] + 5, eye[1] - 5);
    });
    pen.globalAlpha = 1;
  }

  function drawScaleBar() {
    const length = [0.01, 0.02, 0.05, 0.1, 0.2, 0.5].find((v) => v * scale > 60) || 0.5;
    pen.strokeStyle = pen.fillStyle = INK;
    pen.lineWidth = 1.5;
    const x = 20, y = height - 20;
    polyline([[x, y - 4], [x, y], [x + length * scale, y], [x + length * scale, y - 4]]);
    pen.stroke();
    pen.font = "12px system-ui, sans-serif";
    pen.fillText(`${Math.round(1000 * length)} mm`, x + 4, y - 8);
  }

  function draw() {
    prepare();
    const now = Number(slider.value) - 1, view = views[now];
    pen.clearRect(0, 0, width, height);
    if (layers.table.checked) drawTable();
    const covered = (k) => (view.covered[k >> 3] >> (7 - (k & 7))) & 1;
    const sets = [{ set: surface, side: 3, colour: (k) => (covered(k) ? layers.covered.checked && COVERED : layers.missing.checked && MISSING) }];
    if (layers.cloud.checked) {
      const age = (k) => now - cloud.acquisition[k];
      sets.push({ set: cloud, side: 2.4, colour: (k) => (age(k) < 0 ? null : age(k) ? CLOUD : KIND[view.kind]) });
    }
    drawPoints(sets);
    drawEllipsoids(view);
    if (layers.regions.checked) drawRegions(view);
    if (layers.cameras.checked) drawCameras(now);
    drawScaleBar();
    const known = view.coverage !== null;
    const gain = 100 * (view.coverage - (now ? views[now - 1].coverage : 0));
    const recovery = view.kind === "recovery" ? ` (activation ${view.activation})` : "";
    caption.textContent = `Acquisition ${now + 1} of ${views.length}: ${KIND_NAME[view.kind]}${recovery}, NBV iteration ${view.iteration}. ` +
      (known ? `Coverage ${(100 * view.coverage).toFixed(1)} % (${gain >= 0 ? "+" : ""}${gain.toFixed(1)}).` : "");
  }

  let waiting = false;
  function redraw() {
    if (waiting) return;
    waiting = true;
    requestAnimationFrame(() => { waiting = false; draw(); });
  }
  canvas.addEventListener("pointerdown", (event) => canvas.setPointerCapture(event.pointerId));
  canvas.addEventListener("pointermove", (event) => {
    if (!event.buttons) return;
    yaw -= event.movementX * 0.008;
    pitch = Math.min(1.57, Math.max(-1.57, pitch + event.movementY * 0.008));
    redraw();
  });
  // The page must still scroll: the wheel zooms only together with Ctrl (or a pinch, which arrives as that).
  canvas.addEventListener("wheel", (event) => {
    if (!event.ctrlKey) return;
    event.preventDefault();
    zoomBy(Math.exp(-event.deltaY * 0.003));
  }, { passive: false });
  function zoomBy(factor) { zoom = Math.min(12, Math.max(0.3, zoom * factor)); redraw(); }
  root.querySelector("[data-zoom=in]").addEventListener("click", () => zoomBy(1.3));
  root.querySelector("[data-zoom=out]").addEventListener("click", () => zoomBy(1 / 1.3));
  root.querySelector("[data-zoom=reset]").addEventListener("click", () => { ({ yaw, pitch, zoom } = start); redraw(); });
  slider.addEventListener("input", redraw);
  Object.values(layers).forEach((box) => box.addEventListener("change", redraw));
  document.querySelectorAll("[data-show]").forEach((link) => link.addEventListener("click", () => {
    slider.value = link.dataset.show;
    redraw();
  }));
  window.addEventListener("resize", redraw);
  draw();
})();
