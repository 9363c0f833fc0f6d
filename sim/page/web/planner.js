"use strict";
/* A robot that finds its way over a map that one draws. */

const FREE = 0, WALL = 1, STEEP = 2;

/* Of joulepath/navigator.h: it stands and looks for a way. Simulated s of a frame then, where it is to be watched: a slice or two. */
const PLANNING = 1;
const WATCHED_S = 0.004;

/* Of a cell, in the search. */
const OPEN = 1, EXPANDED = 2;

/* Of the library (joulepath/planner.h), as people say it. */
const ANSWERS = ["no route yet", "optimal: proved", "within a bound", "partial", "unreachable: proved", "stale"];

/** Hills: sums of smooth bumps. Each reaches so many cells, and at its steepest is a share of what the robot can climb. */
const BUMP_CELLS = 8;
const BUMP_GRADE = 0.07;

class PlannerScene {
  static title = "Planner";

  constructor(core, canvas, say) {
    Object.assign(this, { core, say });
    this.plane = new Plane(canvas);
    this.width = 80;
    this.height = 56;
    this.robots = Array.from({ length: core.exports.planner_robots() }, (_, i) => core.text(core.exports.planner_robot_name(i)));
    this.robot = Math.max(0, this.robots.indexOf("zhang2018")); // made for hills
    this.memory = 1024;
    this.seed = 1;
    this.tool = "wall";
    this.isWatched = true;
    this.start = { x: 8, y: 8 };
    this.goal = { x: 70, y: 46 };
    this.cursor = { x: 40, y: 28 };
    this.walls = new Uint8Array(this.width * this.height);
    this.searched = new Uint8Array(this.width * this.height);
    this.bumps = new Map(); // "x,y" → strokes
    this.drawExample();
  }

  /** Two walls with a gap, and a hill between start and goal. */
  drawExample() {
    for (let y = 0; y < 36; y++) {
      this.walls.fill(WALL, y * this.width + 26, y * this.width + 28);
    }
    for (let y = 22; y < this.height; y++) {
      this.walls.fill(WALL, y * this.width + 56, y * this.width + 58);
    }
    for (const [x, y, strokes] of [[40, 30, 1], [44, 22, 1], [40, 38, 1], [42, 12, -1], [48, 44, 1]]) {
      this.bumps.set(`${x},${y}`, strokes);
    }
  }

  get labels() {
    return { help: "Map of walls and hills. Arrow keys move the cursor, Enter uses the chosen tool there." };
  }

  /* ---- Links ---- */

  /** Runs of cells that are alike, in base 36, beginning with free ones. */
  static pack(cells) {
    const runs = [];
    let kind = FREE;
    let run = 0;
    for (const cell of cells) {
      if ((cell === WALL ? WALL : FREE) !== kind) {
        runs.push(run);
        kind = WALL - kind;
        run = 0;
      }
      run++;
    }
    return [...runs, run].map((length) => length.toString(36)).join(".");
  }

  static unpack(text, count) {
    const cells = new Uint8Array(count);
    let at = 0;
    text.split(".").forEach((length, i) => {
      const run = parseInt(length, 36);
      cells.fill(i % 2 ? WALL : FREE, at, at + (run || 0));
      at += run;
    });
    return at === count ? cells : null;
  }

  link() {
    return {
      robot: this.robots[this.robot], memory: this.memory, seed: this.seed, start: `${this.start.x},${this.start.y}`, goal: `${this.goal.x},${this.goal.y}`,
      walls: PlannerScene.pack(this.walls), hills: [...this.bumps].map(([place, strokes]) => `${place},${strokes}`).join(";"),
    };
  }

  cellOf(text, otherwise) {
    const [x, y] = (text ?? "").split(",").map(Number);
    return x >= 0 && x < this.width && y >= 0 && y < this.height ? { x: Math.floor(x), y: Math.floor(y) } : otherwise;
  }

  follow(link) {
    const robot = this.robots.indexOf(link.get("robot"));
    this.robot = robot < 0 ? this.robot : robot;
    this.memory = Number(link.get("memory")) || this.memory;
    this.seed = Math.max(1, Math.floor(Number(link.get("seed"))) || this.seed);
    this.start = this.cellOf(link.get("start"), this.start);
    this.goal = this.cellOf(link.get("goal"), this.goal);
    this.walls = (link.has("walls") && PlannerScene.unpack(link.get("walls"), this.width * this.height)) || this.walls;
    if (link.has("hills")) {
      const bumps = link.get("hills").split(";").map((text) => text.split(",").map(Number)).filter((bump) => bump.length === 3 && bump.every(Number.isInteger));
      this.bumps = new Map(bumps.slice(0, 400).map(([x, y, strokes]) => [`${x},${y}`, strokes]));
    }
  }

  /* ---- Panel ---- */

  build(panel, below) {
    const tools = [["wall", "Wall"], ["erase", "Erase"], ["hill", "Hill"], ["dig", "Dig"], ["goal", "Goal"], ["start", "Start"]];
    this.toolButtons = tools.map(([tool, text]) => button(text, `tool-${tool}`, () => this.choose(tool)));
    this.table = make("table", { id: "search" });
    this.chart = new Chart(make("canvas", { className: "chart", id: "improves", role: "img", "aria-label": "Energy of the best route against the states that the search has expanded" }),
      "expansions", "route, J");
    panel.replaceChildren(
      section("Draw", make("div", { className: "row", role: "group", "aria-label": "Tool" }, ...this.toolButtons),
        make("p", { className: "hint" }, "Draw on the map. Walls and the goal may change while it drives: it repairs its plan. Hills begin the drive anew; brown is high, blue is low, red hatching is too steep for the robot."),
        make("div", { className: "row" }, button("Clear the map", "clear", () => this.clear()), button("Save the map", "save", () => this.save()))),
      section("Robot and memory",
        choice("Robot", "robot", this.robots.map((name, i) => [i, name]), this.robot, (value) => { this.robot = Number(value); this.reset(); }),
        choice("Planner's block", "memory", [4, 8, 16, 64, 256, 1024, 4096].map((kib) => [kib, `${kib} KiB`]), this.memory, (value) => { this.memory = Number(value); this.reset(); })),
      section("Search", this.legend(), this.table));
    below.replaceChildren(
      section("Joules of the best route against the search", this.chart.canvas),
      section("The same on the command line", make("pre", { id: "command" }), make("p", { className: "hint" }, "With the map that Save the map gives you, before anything is changed on the way.")));
    this.choose(this.tool);
  }

  /** What the shades and lines mean, and whether it is slowed down to be watched. */
  legend() {
    const watch = make("input", { type: "checkbox", id: "watch", checked: this.isWatched, onchange: () => { this.isWatched = watch.checked; } });
    return make("div", {},
      legend(["area", "frontier", "at the frontier: waits to be expanded"], ["area", "expanded", "expanded: its cost to the goal is known"],
        ["line", "plan", "the planner's route"], ["dashed", "goal", "the course that the robot makes of it"], ["line", "driven", "where it was"],
        ["dotted", "faint", "the route before the last change"]),
      make("label", { className: "row" }, watch, "Slow while it searches"));
  }

  choose(tool) {
    this.tool = tool;
    this.toolButtons.forEach((one) => one.setAttribute("aria-pressed", one.id === `tool-${tool}`));
  }

  clear() {
    this.walls.fill(FREE);
    this.bumps.clear();
    this.reset();
  }

  /** As tools/design/import_map.py writes maps. */
  mapFile() {
    const rows = Array.from({ length: this.height }, (_, i) => this.height - 1 - i);
    const cells = (y) => Array.from({ length: this.width }, (_, x) => y * this.width + x);
    const map = {
      format: "joulepath-map-1", name: "page", width: this.width, height: this.height, resolution_m: Math.round(this.cell * 1e4) / 1e4, origin_m: [0, 0, 0],
      note: "drawn by hand", rows: rows.map((y) => cells(y).map((i) => (this.walls[i] === WALL ? "#" : ".")).join("")),
    };
    if (this.bumps.size > 0) {
      map.elevation_m = rows.map((y) => cells(y).map((i) => this.elevations[i] / 1024));
    }
    return map;
  }

  save() {
    const link = make("a", { href: URL.createObjectURL(new Blob([JSON.stringify(this.mapFile())], { type: "application/json" })), download: "map.json" });
    link.click();
    this.say("The map is saved as map.json.");
  }

  command() {
    const middle = ({ x, y }) => [x, y].map((cell) => ((cell + 0.5) * Math.round(this.cell * 1e4) / 1e4).toFixed(3)).join(",");
    return `build/bin/jp-navigate map.json --hidden 0 \\\n  --memory ${this.memory} --seed ${this.seed} \\\n  --robot ${this.robots[this.robot]} \\\n  --start ${middle(this.start)},${this.headingDegrees.toFixed(3)} \\\n  --goal ${middle(this.goal)}`;
  }

  /* ---- Drive ---- */

  /** The heading of the lattice that looks most towards the goal. */
  chooseHeading() {
    const wanted = Math.atan2(this.goal.y - this.start.y, this.goal.x - this.start.x);
    const away = (heading) => Math.abs(Math.atan2(Math.sin(heading - wanted), Math.cos(heading - wanted)));
    const headings = Array.from({ length: 16 }, (_, i) => this.core.exports.planner_heading(i));
    const best = headings.reduce((least, heading, i) => (away(heading) < away(headings[least]) ? i : least), 0);
    this.headingDegrees = (headings[best] * 180) / Math.PI;
    return best;
  }

  /** Elevations in 2⁻¹⁰ m: the same numbers in every browser. */
  raise() {
    this.elevations = new Int16Array(this.width * this.height);
    const top = (BUMP_GRADE * BUMP_CELLS * this.cell) / 1.54; // (1 − r²)² is at its steepest 1.54
    const heights = new Float64Array(this.width * this.height);
    for (const [place, strokes] of this.bumps) {
      const [cx, cy] = place.split(",").map(Number);
      for (let y = Math.max(0, cy - BUMP_CELLS); y <= Math.min(this.height - 1, cy + BUMP_CELLS); y++) {
        for (let x = Math.max(0, cx - BUMP_CELLS); x <= Math.min(this.width - 1, cx + BUMP_CELLS); x++) {
          const near = 1 - ((x - cx) ** 2 + (y - cy) ** 2) / BUMP_CELLS ** 2;
          heights[y * this.width + x] += near > 0 ? strokes * top * near * near : 0;
        }
      }
    }
    heights.forEach((height, i) => { this.elevations[i] = Math.max(-32000, Math.min(32000, Math.round(1024 * height))); });
  }

  reset() {
    const { exports } = this.core;
    this.cell = exports.planner_new(this.robot, this.width, this.height);
    this.raise();
    new Int16Array(exports.memory.buffer, exports.planner_elevations(), this.elevations.length).set(this.elevations);
    new Uint8Array(exports.memory.buffer, exports.planner_marks(), this.walls.length).set(this.walls.map((cell) => (cell === WALL ? WALL : FREE)));
    this.trail = [];
    this.improved = [];
    this.old = [];
    this.due = 0;
    this.over = false;
    this.status = exports.planner_begin(this.start.x, this.start.y, this.chooseHeading(), this.goal.x, this.goal.y, this.memory, this.seed);
    this.look();
    element("command").textContent = this.command();
    if (this.status === -10) {
      this.say(`The block is too small: this map needs ${exports.planner_memory_min()} KiB at least.`);
    } else {
      this.say(this.status === 0 ? "It searches its way." : `It cannot go: ${Core.reason(this.status)}.`);
    }
  }

  look() {
    this.view = this.core.view("planner");
    this.walls.set(this.cells(this.core.exports.planner_marks()));
    this.searched.set(this.cells(this.core.exports.planner_searched()));
    this.route = this.points(this.core.exports.planner_route());
    this.course = this.points(this.core.exports.planner_course());
    this.isStale = this.route.some(({ x, y }) => this.walls[Math.floor(y / this.cell) * this.width + Math.floor(x / this.cell)] !== FREE);
  }

  cells(pointer) {
    return new Uint8Array(this.core.exports.memory.buffer, pointer, this.walls.length);
  }

  points(count) {
    const numbers = this.core.doubles(this.core.exports.planner_points(), 2 * count);
    return Array.from({ length: count }, (_, i) => ({ x: numbers[2 * i], y: numbers[2 * i + 1] }));
  }

  get isSearching() {
    return this.view.state === PLANNING;
  }

  run(seconds) {
    if (this.status !== 0) {
      return;
    }
    const rate = this.core.exports.planner_ticks_a_second();
    this.due += (this.isWatched && this.isSearching ? Math.min(seconds, WATCHED_S) : seconds) * rate;
    const before = this.view.state;
    while (this.due >= 1) {
      const ticks = Math.min(Math.max(1, Math.floor(rate / 50)), Math.floor(this.due));
      const done = this.core.exports.planner_run(ticks);
      this.due = done < ticks ? 0 : this.due - ticks;
      this.note();
    }
    this.look();
    if (this.view.state !== before) {
      this.report();
    }
  }

  note() {
    const view = this.core.view("planner");
    const last = this.trail[this.trail.length - 1];
    const cost = this.improved[this.improved.length - 1];
    if (!last || Math.hypot(view.x_m - last.x, view.y_m - last.y) > this.cell / 8) {
      this.trail.push({ x: view.x_m, y: view.y_m });
    }
    if (Number.isFinite(view.plan_j) && (!cost || cost[1] !== view.plan_j)) {
      this.improved.push([view.expansions, view.plan_j]);
    }
  }

  report() {
    const { state, replans, driven_j, forecast_j } = this.view;
    const name = this.core.text(this.core.exports.planner_state_name());
    const reason = this.core.text(this.core.exports.planner_reason_name());
    const texts = {
      arrived: `There: ${shown(driven_j)} J driven, ${shown(forecast_j)} J foretold by the last course, planned anew ${replans === 1 ? "once" : `${replans} times`}.`,
      unreachable: "No way leads there: proved.",
      failed: `It has given up: ${reason}.`,
      braking: `It brakes: ${reason}.`,
      planning: "It searches its way.",
      driving: "It drives.",
    };
    this.say(texts[name] ?? `It is ${name}.`);
  }

  gauges() {
    const { forecast_j, deviation_j, driven_j, drawn_j, capacity_j, bus_voltage_v, time_s } = this.view;
    return {
      forecast: interval(forecast_j, deviation_j), driven: `${shown(driven_j)} J`,
      battery: Number.isFinite(capacity_j) ? battery(drawn_j, capacity_j) : drawn(drawn_j, bus_voltage_v), time: `${shown(time_s)} s`,
    };
  }

  /* ---- Hands ---- */

  cellAt(place) {
    const cell = { x: Math.floor(place.x / this.cell), y: Math.floor(place.y / this.cell) };
    return cell.x >= 0 && cell.y >= 0 && cell.x < this.width && cell.y < this.height ? cell : null;
  }

  press(place) {
    this.last = null;
    this.isLandChanged = false;
    this.cursor = this.cellAt(place) ?? this.cursor;
    this.drag(place);
  }

  drag(place) {
    const cell = this.cellAt(place);
    if (cell && (!this.last || cell.x !== this.last.x || cell.y !== this.last.y)) {
      this.use(this.last ?? cell, cell);
      this.last = cell;
    }
  }

  release() {
    if (this.last && (this.tool === "wall" || this.tool === "erase") && this.status === 0 && this.view.state > 7) {
      this.setGoal(this.goal); // a way that was none may be one now
    } else if (this.isLandChanged) {
      this.isLandChanged = false;
      this.reset();
    } else if (this.last && this.tool === "goal") {
      this.setGoal(this.last);
    } else if (this.last && this.tool === "start") {
      this.start = this.last;
      this.reset();
    }
    this.last = null;
  }

  /** The tool along a line of cells. */
  use(from, to) {
    const steps = Math.max(1, Math.abs(to.x - from.x), Math.abs(to.y - from.y));
    for (let i = 1; i <= steps; i++) {
      const x = Math.round(from.x + ((to.x - from.x) * i) / steps);
      const y = Math.round(from.y + ((to.y - from.y) * i) / steps);
      if (this.tool === "wall" || this.tool === "erase") {
        this.brush(x, y, this.tool === "wall");
      } else if (this.tool === "hill" || this.tool === "dig") {
        this.heap(x, y, this.tool === "hill" ? 1 : -1);
      }
    }
  }

  brush(x, y, isWall) {
    if (this.old.length === 0 && this.route.length > 0) {
      this.old = this.route;
    }
    for (let v = y; v <= Math.min(y + 1, this.height - 1); v++) {
      for (let u = x; u <= Math.min(x + 1, this.width - 1); u++) {
        this.core.exports.planner_wall(u, v, isWall);
      }
    }
    this.look();
  }

  heap(x, y, amount) {
    const place = `${Math.round(x / 2) * 2},${Math.round(y / 2) * 2}`;
    const strokes = Math.max(-9, Math.min(9, (this.bumps.get(place) ?? 0) + amount));
    this.bumps.set(place, strokes);
    if (strokes === 0) {
      this.bumps.delete(place);
    }
    this.isLandChanged = true;
    this.raise();
  }

  setGoal(cell) {
    this.goal = cell;
    if (this.status !== 0 || this.core.exports.planner_is_over()) {
      if (this.view.state >= 7 && this.core.exports.planner_goal(cell.x, cell.y) === 0) {
        this.say("It searches its way.");
      } else {
        this.reset();
      }
      return;
    }
    const status = this.core.exports.planner_goal(cell.x, cell.y);
    this.say(status === 0 ? "Another goal: it plans anew." : `It cannot go there: ${Core.reason(status)}.`);
  }

  key(name) {
    const move = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, 1], ArrowDown: [0, -1] }[name];
    if (move) {
      this.cursor = { x: Math.max(0, Math.min(this.width - 1, this.cursor.x + move[0])), y: Math.max(0, Math.min(this.height - 1, this.cursor.y + move[1])) };
      const i = this.cursor.y * this.width + this.cursor.x;
      this.say(`Cell ${this.cursor.x}, ${this.cursor.y}: ${["free", "wall", "too steep"][this.walls[i]]}, ${shown(this.elevations[i] / 1024, 2)} m high.`);
    } else if (name === "Enter") {
      this.press({ x: (this.cursor.x + 0.5) * this.cell, y: (this.cursor.y + 0.5) * this.cell });
      this.release();
    } else {
      return false;
    }
    return true;
  }

  /* ---- Pictures ---- */

  draw() {
    this.plane.fit(0, 0, this.width * this.cell, this.height * this.cell);
    const context = this.plane.begin();
    this.drawGround(context);
    this.drawSearched(context);
    this.plane.grid();
    this.plane.line(this.old, css("faint"), 2, [2, 4]);
    this.plane.line(this.route, css(this.isStale ? "faint" : "plan"), 2, this.isStale ? [2, 4] : []);
    this.plane.line(this.course, css("goal"), 2, [7, 4]);
    this.plane.line(this.trail, css("driven"), 2.5);
    const middle = ({ x, y }) => ({ x: (x + 0.5) * this.cell, y: (y + 0.5) * this.cell });
    this.plane.marker(middle(this.start), 9, css("faint"), "S");
    this.plane.marker(middle(this.goal), 10, css("goal"), "G");
    this.drawCursor(context);
    if (this.status === 0) {
      this.drawRobot();
    }
    this.drawTables();
  }

  drawGround(context) {
    const picture = (this.picture ??= document.createElement("canvas"));
    picture.width = this.width;
    picture.height = this.height;
    const brush = picture.getContext("2d");
    const image = brush.createImageData(this.width, this.height);
    const highest = Math.max(1, ...this.elevations.map(Math.abs));
    const wall = colourOf("wall");
    for (let y = 0; y < this.height; y++) {
      for (let x = 0; x < this.width; x++) {
        const i = y * this.width + x;
        const at = 4 * ((this.height - 1 - y) * this.width + x);
        const height = this.elevations[i] / highest;
        const hatched = this.walls[i] === STEEP && (x + y) % 2 === 0;
        const colour = this.walls[i] === WALL ? [...wall, 255]
          : hatched ? [220, 40, 40, 190]
            : height > 0 ? [180, 120, 40, 200 * height] : [50, 110, 200, -160 * height];
        image.data.set(colour, at);
      }
    }
    context.fillStyle = css("panel");
    context.fillRect(...this.window());
    brush.putImageData(image, 0, 0);
    context.imageSmoothingEnabled = false;
    context.drawImage(picture, ...this.window());
  }

  /** The map on the canvas: left, top, width, height. */
  window() {
    const { plane } = this;
    return [plane.x(0), plane.y(this.height * this.cell), this.width * this.cell * plane.scale, this.height * this.cell * plane.scale];
  }

  /** A square in the middle of each cell that the search has met. */
  drawSearched(context) {
    const size = this.cell * this.plane.scale;
    for (const [kind, name] of [[EXPANDED, "expanded"], [OPEN, "frontier"]]) {
      context.fillStyle = css(name);
      this.searched.forEach((found, i) => {
        if (found === kind) {
          const x = this.plane.x((i % this.width) * this.cell);
          const y = this.plane.y((Math.floor(i / this.width) + 1) * this.cell);
          context.fillRect(x + size / 5, y + size / 5, 0.6 * size, 0.6 * size);
        }
      });
    }
  }

  drawCursor(context) {
    if (document.activeElement === this.plane.canvas) {
      context.strokeStyle = css("driven");
      context.lineWidth = 2;
      context.strokeRect(this.plane.x(this.cursor.x * this.cell), this.plane.y((this.cursor.y + 1) * this.cell), this.cell * this.plane.scale, this.cell * this.plane.scale);
    }
  }

  drawRobot() {
    const { x_m, y_m, heading_rad, length_m, width_m } = this.view;
    this.plane.at({ x: x_m, y: y_m, heading: heading_rad }, width_m, 8, (context) => {
      context.fillStyle = css("driven");
      context.strokeStyle = css("ink");
      context.fillRect(-length_m / 2, -width_m / 2, length_m, width_m);
      context.strokeRect(-length_m / 2, -width_m / 2, length_m, width_m);
      context.beginPath();
      context.moveTo(0, 0);
      context.lineTo(length_m / 2, 0);
      context.stroke();
    });
  }

  drawTables() {
    const view = this.view;
    const kib = (bytes) => `${shown(bytes / 1024)} KiB`;
    const answer = view.state === 8 ? "none: proved" : this.isStale ? "the last one is blocked" : view.answer === 2 && Number.isFinite(view.plan_bound) ? `within ${shown(view.plan_bound, 2)} of the optimum` : ANSWERS[view.answer] ?? "–";
    const rows = [
      ["robot", this.core.text(this.core.exports.planner_state_name())],
      ["route", answer],
      ["joules of the route", `${shown(view.plan_j)} J`],
      ["states expanded", shown(view.expansions, 0)],
      ["– by the first search", shown(view.first_expansions, 0)],
      ["– since the last change", shown(view.repair_expansions, 0)],
      ["cells expanded", shown(this.searched.filter((found) => found === EXPANDED).length, 0)],
      ["cells at the frontier", shown(this.searched.filter((found) => found === OPEN).length, 0)],
      ["states kept", `${shown(view.states, 0)} of ${shown(view.states_max, 0)}`],
      ["block: guide", kib(view.guide_bytes)],
      ["block: energy field", view.field_bytes === 0 ? "does not fit" : kib(view.field_bytes)],
      ["block: search", kib(view.search_bytes)],
      ["planned anew", shown(view.replans, 0)],
      ["driven", `${shown(view.driven_m, 2)} m`],
      ["touched a wall", Number.isFinite(view.is_touched) ? (view.is_touched ? "YES" : "no") : "–"],
    ];
    const text = JSON.stringify(rows);
    if (text !== this.tableText) {
      this.tableText = text;
      fillTable(this.table, ["", ""], rows);
    }
    this.chart.draw([{ points: this.improved, colour: css("plan") }, { points: this.improved, colour: css("plan"), dots: 3 }]);
  }
}
