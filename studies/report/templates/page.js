"use strict";
/* What every report does: theme, plots from the embedded figures, moved by keys, tables. */
(() => {
  const data = JSON.parse(document.getElementById("data").textContent);
  const root = document.documentElement;
  const plots = [];
  const PAPER_PX = 660;  // as wide as the text of a page of A4 or letter with this style's margins
  let printing = false;
  const of = (name) => getComputedStyle(root).getPropertyValue(name).trim();

  /* Colours of plotly's own parts; a trace that says "ink" has the text's colour. */
  const coloured = (value) => (value === "ink" ? of("--ink") : value === "bad" ? of("--bad") : value);
  function themed(figure) {
    const ink = of("--ink"), line = of("--line"), paper = of("--paper");
    const layout = structuredClone(figure.layout);
    if (printing && !layout.scene) layout.width = PAPER_PX;
    Object.assign(layout, { paper_bgcolor: paper, plot_bgcolor: paper, font: { color: ink, size: 13 } });
    layout.legend = Object.assign({ orientation: "h", y: -0.22 }, layout.legend);
    layout.hoverlabel = { bgcolor: of("--panel"), font: { color: ink } };
    for (const axis of Object.keys(layout).filter((key) => /^[xy]axis\d*$/.test(key))) {
      Object.assign(layout[axis], { gridcolor: line, linecolor: of("--soft"), zerolinecolor: line });
    }
    for (const shape of layout.shapes || []) shape.line.color = coloured(shape.line.color);
    for (const note of layout.annotations || []) note.font = { color: coloured(note.font?.color || "ink") };
    if (layout.scene) {
      for (const axis of ["xaxis", "yaxis", "zaxis"]) {
        Object.assign(layout.scene[axis], { gridcolor: line, color: ink, backgroundcolor: paper });
      }
    }
    const traces = structuredClone(figure.data);
    for (const trace of traces) {
      if (trace.marker) trace.marker.color = coloured(trace.marker.color);
      if (trace.marker?.line) trace.marker.line.color = coloured(trace.marker.line.color);
      if (trace.line) trace.line.color = coloured(trace.line.color);
    }
    return [traces, layout];
  }
  const config = { displaylogo: false, responsive: true, scrollZoom: false };
  const buttons = (figure) => (figure.layout.scene
    ? [["toImage", "resetCameraDefault3d"]]
    : [["toImage", "zoom2d", "pan2d", "zoomIn2d", "zoomOut2d", "autoScale2d"]]);
  /* A plot says what it shows in words: its drawing's own letters and icons are no text. */
  async function draw(plot) {
    await Plotly.react(
      plot.element, ...themed(plot.figure), { ...config, modeBarButtons: buttons(plot.figure) });
    const drawings = [...plot.element.querySelectorAll("svg, canvas"), document.getElementById("js-plotly-tester")];
    for (const drawing of drawings.filter(Boolean)) drawing.setAttribute("aria-hidden", "true");
    for (const bar of plot.element.querySelectorAll("[role=toolbar]")) {
      bar.setAttribute("aria-label", `Tools of the plot: ${plot.element.dataset.name}`);
    }
  }
  const redraw = () => Promise.all(plots.map(draw));

  /* The page is printed before the next animation frame, in which WebGL would draw or change its size. */
  function print_bodies() {
    for (const { element, figure } of plots) {
      if (!figure.layout.scene) continue;
      element._fullLayout.scene._scene.glplot.redraw();
      element.style.zoom = Math.min(1, PAPER_PX / element.clientWidth);
    }
  }

  /* Theme: the system's until the button is pressed. */
  const system = matchMedia("(prefers-color-scheme: dark)");
  const dark = () => (root.dataset.theme ? root.dataset.theme === "dark" : system.matches);
  const button = document.getElementById("theme");
  const named = () => { button.textContent = dark() ? "Light colours" : "Dark colours"; };
  button.hidden = false;
  named();
  button.addEventListener("click", () => {
    root.dataset.theme = dark() ? "light" : "dark";
    named();
    redraw();
  });
  system.addEventListener("change", () => { named(); redraw(); });
  let before;
  addEventListener("beforeprint", () => {
    before = root.dataset.theme;
    root.dataset.theme = "light";
    printing = true;
    redraw();
    print_bodies();
  });
  addEventListener("afterprint", () => {
    printing = false;
    for (const { element } of plots) element.style.zoom = "";
    if (before) root.dataset.theme = before; else delete root.dataset.theme;
    redraw().then(() => plots.forEach((plot) => Plotly.Plots.resize(plot.element)));
  });

  /* Zoom and shift of the x axis, by keys and by buttons. */
  function move(element, how) {
    const axis = element._fullLayout.xaxis;
    if (how === "all") {
      Plotly.relayout(element, Object.fromEntries(Object.keys(element._fullLayout)
        .filter((key) => /^[xy]axis\d*$/.test(key)).map((key) => [`${key}.autorange`, true])));
      return;
    }
    const [low, high] = axis.range, middle = (low + high) / 2, half = (high - low) / 2;
    const wide = how === "in" ? half / 2 : how === "out" ? half * 2 : half;
    const shift = how === "left" ? -half / 2 : how === "right" ? half / 2 : 0;
    Plotly.relayout(element, { "xaxis.range": [middle + shift - wide, middle + shift + wide] });
  }
  /* Turns a body about its upright axis and up and down, and goes nearer; the eye is relative to the body. */
  const TURN = Math.PI / 18;
  const steepest = 1.45;  // from the horizon; at the pole there is no left and right
  function turn(element, how) {
    if (how === "all") {
      Plotly.relayout(element, { "scene.camera": data.body.figure.layout.scene.camera });
      return;
    }
    const { x, y, z } = element._fullLayout.scene._scene.getCamera().eye;
    const flat = Math.hypot(x, y);
    const far = Math.hypot(flat, z) * ({ in: 0.8, out: 1.25 }[how] || 1);
    const about = Math.atan2(y, x) + ({ left: -TURN, right: TURN }[how] || 0);
    const up = Math.atan2(z, flat) + ({ up: TURN, down: -TURN }[how] || 0);
    const tilt = Math.max(-steepest, Math.min(steepest, up));
    const across = far * Math.cos(tilt);
    Plotly.relayout(element, {
      "scene.camera.eye": { x: across * Math.cos(about), y: across * Math.sin(about), z: far * Math.sin(tilt) },
    });
  }
  const solid = { ArrowUp: "up", ArrowDown: "down" };
  const keys = { "+": "in", "=": "in", "-": "out", ArrowLeft: "left", ArrowRight: "right", 0: "all" };
  for (const control of document.querySelectorAll("button[data-move]")) {
    control.addEventListener("click", () => {
      const element = document.getElementById(control.getAttribute("aria-controls"));
      if (control.dataset.from) {
        Plotly.relayout(element, { "xaxis.range": [Number(control.dataset.from), Number(control.dataset.to)] });
      } else move(element, control.dataset.move);
    });
  }

  /* Tables: sorted by their headings, filtered by the words of a box and by status. */
  const rank = (cell) => {
    const text = cell.dataset.v ?? cell.textContent.trim();
    return text === "" || text === "-" ? null : isNaN(text) ? text : Number(text);
  };
  function compare(one, two, sign) {
    if (one === null || two === null) return (one === null) - (two === null);
    if (typeof one === "number" && typeof two === "number") return sign * (one - two);
    return sign * String(one).localeCompare(String(two), "en");
  }
  for (const table of document.querySelectorAll("table.rows")) {
    const body = table.tBodies[0], heads = [...table.tHead.rows[0].cells];
    heads.forEach((head, column) => head.querySelector("button").addEventListener("click", () => {
      const down = head.getAttribute("aria-sort") === "ascending";
      heads.forEach((other) => other.setAttribute("aria-sort", "none"));
      head.setAttribute("aria-sort", down ? "descending" : "ascending");
      const rows = [...body.rows].map((row) => [rank(row.cells[column]), row]);
      rows.sort((one, two) => compare(one[0], two[0], down ? -1 : 1));
      body.append(...rows.map((row) => row[1]));
    }));
    const box = document.getElementById(`${table.id}-filter`);
    const status = document.getElementById(`${table.id}-status`);
    const count = document.getElementById(`${table.id}-count`);
    if (!box) continue;
    const filter = () => {
      const words = box.value.toLowerCase().split(/\s+/).filter(Boolean);
      let shown = 0;
      for (const row of body.rows) {
        const text = row.textContent.toLowerCase();
        row.hidden = !words.every((word) => text.includes(word))
          || Boolean(status && status.value && row.dataset.status !== status.value);
        shown += !row.hidden;
      }
      count.textContent = `${shown} of ${body.rows.length} rows`;
    };
    box.addEventListener("input", filter);
    if (status) status.addEventListener("change", filter);
    filter();
  }

  /* A body's surface, 32-bit numbers in base64: its points at a step, deformed. */
  const bytes = (text) => Uint8Array.from(atob(text), (letter) => letter.charCodeAt(0));
  function body(spec) {
    const rest = new Float32Array(bytes(spec.rest).buffer);
    const moved = new Float32Array(bytes(spec.moved).buffer);
    const faces = new Uint32Array(bytes(spec.faces).buffer);
    const count = rest.length / 3;
    const pick = (array, part) => Array.from({ length: array.length / 3 }, (_, index) => array[3 * index + part]);
    const at = (step) => {
      const from = step * rest.length, length = new Array(count), place = [0, 1, 2].map(() => new Array(count));
      for (let node = 0; node < count; node++) {
        let square = 0;
        for (let part = 0; part < 3; part++) {
          const by = moved[from + 3 * node + part];
          square += by * by;
          place[part][node] = (rest[3 * node + part] + by) * 1e3;
        }
        length[node] = Math.sqrt(square) * 1e3;
      }
      return { x: place[0], y: place[1], z: place[2], intensity: length };
    };
    const probes = (step) => ({ x: [spec.probe[step][0] * 1e3], y: [spec.probe[step][1] * 1e3], z: [spec.probe[step][2] * 1e3] });
    const figure = spec.figure;
    Object.assign(figure.data[0], at(spec.shown), { i: pick(faces, 0), j: pick(faces, 1), k: pick(faces, 2) });
    Object.assign(figure.data[1], probes(spec.shown));
    const slider = document.getElementById("step"), says = document.getElementById("step-says");
    const show = (step) => {
      Object.assign(figure.data[0], at(step));
      Object.assign(figure.data[1], probes(step));
      says.textContent = spec.labels[step];
      slider.setAttribute("aria-valuetext", spec.labels[step]);
    };
    slider.addEventListener("input", () => {
      show(Number(slider.value));
      draw(plots.find((plot) => plot.figure === figure));
    });
    document.getElementById("steps").hidden = false;
    show(spec.shown);
    return figure;
  }

  async function start() {
    const packed = bytes(document.getElementById("plotly").textContent.trim());
    const stream = new Blob([packed]).stream().pipeThrough(new DecompressionStream("gzip"));
    const script = document.createElement("script");
    script.textContent = await new Response(stream).text();
    document.head.append(script);
    const figures = data.body ? [...data.figures, body(data.body)] : data.figures;
    for (const figure of figures) {
      const element = document.getElementById(figure.id);
      const plot = { element, figure };
      plots.push(plot);
      await draw(plot);
      element.tabIndex = 0;
      const [act, known] = figure.layout.scene ? [turn, { ...keys, ...solid }] : [move, keys];
      element.addEventListener("keydown", (event) => {
        if (event.target !== element || !(event.key in known)) return;
        if (event.ctrlKey || event.metaKey || event.altKey) return;
        event.preventDefault();
        act(element, known[event.key]);
      });
    }
    root.dataset.ready = "yes";
  }
  start().catch((error) => {
    const trouble = document.getElementById("trouble");
    trouble.hidden = false;
    trouble.textContent = `The plots cannot be drawn here (${error.message}); every figure is in the tables.`;
    root.dataset.ready = "no";
  });
})();
