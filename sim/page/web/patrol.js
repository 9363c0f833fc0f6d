"use strict";
/* The patrol robot among people whom one sends about. */

const PERSON_GAP = 0.45; // that a new person keeps to walls, m

class PatrolScene {
  static title = "Patrol";

  constructor(core, canvas, say) {
    Object.assign(this, { core, say });
    this.plane = new Plane(canvas);
    this.kinds = Array.from({ length: core.exports.patrol_scenes() }, (_, i) => core.text(core.exports.patrol_scene_name(i)));
    this.kind = this.kinds.indexOf("warehouse");
    this.seed = 1;
    this.people = []; // added by hand, where they stand at the beginning
    this.chosen = -1;
  }

  get labels() {
    return { help: "The robot's surroundings. Page up and Page down choose a person, arrow keys send that person half a metre." };
  }

  /* ---- Links ---- */

  link() {
    return { kind: this.kinds[this.kind], seed: this.seed, people: this.people.map(({ x, y }) => `${+x.toFixed(2)},${+y.toFixed(2)}`).join(";") };
  }

  follow(link) {
    const kind = this.kinds.indexOf(link.get("kind"));
    this.kind = kind < 0 ? this.kind : kind;
    this.seed = Math.max(1, Math.floor(Number(link.get("seed"))) || this.seed);
    if (link.has("people")) {
      const people = link.get("people").split(";").map((text) => text.split(",").map(Number));
      this.people = people.filter((at) => at.length === 2 && at.every((value) => value > 0 && value < 100)).slice(0, 20).map(([x, y]) => ({ x, y }));
    }
  }

  /* ---- Panel ---- */

  build(panel, below) {
    this.table = make("table", { id: "drive-table" });
    this.seedField = make("input", { type: "number", id: "seed", min: 1, max: 1000000, value: this.seed, onchange: () => { this.seed = Math.max(1, Math.floor(this.seedField.valueAsNumber) || 1); this.people = []; this.reset(); } });
    this.places = new Places([], (i) => `person ${i + 1}`, () => this.sendAll(), true);
    this.chart = new Chart(make("canvas", { className: "chart", id: "spent", role: "img", "aria-label": "Energy over time of this drive, beside its forecast" }), "time, s", "energy, J");
    panel.replaceChildren(
      section("Scene", choice("Scene", "kind", this.kinds.map((name, i) => [i, name]), this.kind, (value) => { this.kind = Number(value); this.people = []; this.reset(); }),
        make("label", { className: "row" }, "Seed", this.seedField)),
      section("People", this.places.element, make("div", { className: "row" }, button("Add a person", "add-person", () => this.add()), button("Send them all away", "nobody", () => { this.people = []; this.reset(); })),
        make("p", { className: "hint" }, "Drag somebody: they walk straight to where you let go, or to the wall before it, at 1.2 m/s, and do not look where the robot is. Adding one begins the drive anew.")),
      section("Drive", this.table));
    below.replaceChildren(
      section("Joules", this.chart.canvas, legend(["line", "driven", "this drive"], ["line", "plan", "its forecast"], ["dashed", "plan", "the forecast's interval of 95 %"])),
      section("On the map", legend(["area", "wall", "walls on its map"], ["area", "unknown", "what its map does not show"], ["area", "person", "people"],
        ["line", "plan", "its path"], ["line", "goal", "the elastic band that it drives"], ["dotted", "driven", "what its laser sees"], ["line", "driven", "where it was"])));
  }

  /* ---- Drive ---- */

  reset() {
    const { exports } = this.core;
    exports.patrol_new(this.kind, this.seed);
    this.people = this.people.filter(({ x, y }) => exports.patrol_add_person(x, y));
    this.hasBegun = exports.patrol_begin(this.seed) !== 0;
    this.view = this.core.view("patrol");
    const { width, height } = this.view;
    this.cells = new Uint8Array(exports.memory.buffer, exports.patrol_cells(), width * height).slice();
    this.trail = [];
    this.spent = [[0, 0]];
    this.due = 0;
    this.targets = new Map();
    this.last = "";
    exports.patrol_run(1);
    this.look();
    this.places.places = this.shapes.slice(0, exports.patrol_people()).filter((shape) => shape.radius > 0).map(({ x, y }) => ({ x, y }));
    this.places.show();
    this.say(this.hasBegun ? "It is on its way to G." : this.core.error);
  }

  look() {
    const { exports } = this.core;
    const pairs = (count, pointer) => {
      const numbers = this.core.doubles(pointer, 2 * count);
      return Array.from({ length: count }, (_, i) => ({ x: numbers[2 * i], y: numbers[2 * i + 1] }));
    };
    this.view = this.core.view("patrol");
    this.path = pairs(exports.patrol_path(), exports.patrol_points());
    this.band = pairs(exports.patrol_band(), exports.patrol_band_points());
    this.scan = pairs(exports.patrol_scan(), exports.patrol_scan_points());
    const count = exports.patrol_shapes();
    const numbers = this.core.doubles(exports.patrol_shape_numbers(), 4 * count);
    this.shapes = Array.from({ length: count }, (_, i) => ({ x: numbers[4 * i], y: numbers[4 * i + 1], heading: numbers[4 * i + 2], radius: numbers[4 * i + 3] }));
  }

  run(seconds) {
    const rate = this.core.exports.patrol_cycles_a_second();
    this.due = Math.min(this.due + seconds * rate, 60);
    const cycles = Math.floor(this.due);
    for (let i = 0; i < cycles; i++) {
      if (this.core.exports.patrol_run(1) === 0) {
        break;
      }
      this.note();
    }
    if (cycles > 0) {
      this.due -= cycles;
      this.look();
      this.report();
    }
  }

  note() {
    const { x_m: x, y_m: y, time_s, driven_j } = this.core.view("patrol");
    const last = this.trail[this.trail.length - 1];
    if (!last || Math.hypot(x - last.x, y - last.y) > 0.02) {
      this.trail.push({ x, y });
    }
    this.spent.push([time_s, driven_j]);
  }

  report() {
    const { exports } = this.core;
    const view = this.view;
    const reason = this.core.text(exports.patrol_reason_name());
    const text = view.is_over
      ? `${this.core.text(exports.patrol_outcome_name())}${reason ? ` (${reason})` : ""}: ${shown(view.driven_j)} J driven, ${shown(view.forecast_j)} J foretold, nearest ${shown(view.clearance_min_m, 2)} m.`
      : `It is ${this.core.text(exports.patrol_state_name())}${reason ? `: ${reason}` : ""}.`;
    if (text !== this.last) {
      this.last = text;
      this.say(text.charAt(0).toUpperCase() + text.slice(1));
    }
  }

  gauges() {
    const { forecast_j, deviation_j, driven_j, bus_voltage_v, time_s } = this.view;
    return { forecast: interval(forecast_j, deviation_j), driven: `${shown(driven_j)} J`, battery: drawn(driven_j, bus_voltage_v), time: `${shown(time_s)} s` };
  }

  /* ---- People ---- */

  send(person, wanted) {
    const place = this.before(this.shapes[person], wanted);
    this.core.exports.patrol_send(person, place.x, place.y);
    this.targets.set(person, place);
    if (this.places.places[person]) {
      this.places.places[person].x = place.x;
      this.places.places[person].y = place.y;
      this.places.show();
    }
  }

  sendAll() {
    this.places.places.forEach((place, i) => {
      const at = this.targets.get(i) ?? this.shapes[i];
      if (Math.hypot(at.x - place.x, at.y - place.y) > 0.05) {
        this.send(i, { ...place });
      }
    });
  }

  /** The last place before a wall, on the way from one to another. */
  before(from, to) {
    const { width, cell_m } = this.view;
    const steps = Math.ceil(Math.hypot(to.x - from.x, to.y - from.y) / cell_m);
    const at = (share) => ({ x: from.x + (to.x - from.x) * share, y: from.y + (to.y - from.y) * share });
    const isSolid = ({ x, y }) => this.cells[Math.floor(y / cell_m) * width + Math.floor(x / cell_m)] !== 0;
    for (let i = 1; i <= steps; i++) {
      if (isSolid(at(i / steps))) {
        return at((i - 1) / steps);
      }
    }
    return to;
  }

  isFree({ x, y }) {
    const { width, height, cell_m } = this.view;
    const reach = Math.ceil(PERSON_GAP / cell_m);
    const [cx, cy] = [Math.floor(x / cell_m), Math.floor(y / cell_m)];
    for (let v = cy - reach; v <= cy + reach; v++) {
      for (let u = cx - reach; u <= cx + reach; u++) {
        if (u < 0 || v < 0 || u >= width || v >= height || this.cells[v * width + u] !== 0) {
          return false;
        }
      }
    }
    return this.people.every((other) => Math.hypot(other.x - x, other.y - y) > 1);
  }

  /** Beside the path, where there is room. */
  add() {
    for (const share of [0.5, 0.7, 0.35, 0.6, 0.8, 0.25, 0.45, 0.55, 0.65]) {
      const at = this.path[Math.floor(share * (this.path.length - 1))];
      for (const [dx, dy] of [[0.9, 0], [-0.9, 0], [0, 0.9], [0, -0.9], [0, 0]]) {
        const place = { x: Math.round((at.x + dx) * 10) / 10, y: Math.round((at.y + dy) * 10) / 10 };
        if (this.isFree(place)) {
          const before = this.people.length;
          this.people.push(place);
          this.reset();
          if (this.people.length > before) {
            this.say(`Person ${this.places.places.length} stands at ${shown(place.x)}, ${shown(place.y)} m.`);
            return;
          }
        }
      }
    }
    this.say("There is no room for more people beside the path.");
  }

  /* ---- Hands ---- */

  press(place) {
    const count = this.core.exports.patrol_people();
    const near = (i) => Math.hypot(this.shapes[i].x - place.x, this.shapes[i].y - place.y) * this.plane.scale;
    const people = Array.from({ length: Math.min(count, this.shapes.length) }, (_, i) => i).filter((i) => near(i) < 26);
    this.held = people.length > 0 ? people.reduce((best, i) => (near(i) < near(best) ? i : best)) : -1;
    this.chosen = this.held >= 0 ? this.held : this.chosen;
  }

  drag(place) {
    if (this.held >= 0) {
      this.wanted = place;
    }
  }

  release() {
    if (this.held >= 0 && this.wanted) {
      this.send(this.held, this.wanted);
      const at = this.targets.get(this.held);
      this.say(`Person ${this.held + 1} goes to ${shown(at.x)}, ${shown(at.y)} m.`);
    }
    this.held = -1;
    this.wanted = null;
  }

  key(name) {
    const move = { ArrowLeft: [-0.5, 0], ArrowRight: [0.5, 0], ArrowUp: [0, 0.5], ArrowDown: [0, -0.5] }[name];
    const turn = { PageDown: 1, PageUp: -1 }[name];
    const count = Math.min(this.core.exports.patrol_people(), this.shapes.length);
    if (count === 0 || (!move && !turn)) {
      return false;
    }
    if (turn) {
      this.chosen = (Math.max(0, this.chosen) + turn + count) % count;
    } else {
      this.chosen = Math.max(0, Math.min(this.chosen, count - 1));
      const from = this.targets.get(this.chosen) ?? this.shapes[this.chosen];
      this.send(this.chosen, { x: from.x + move[0], y: from.y + move[1] });
    }
    const at = this.targets.get(this.chosen) ?? this.shapes[this.chosen];
    this.say(`Person ${this.chosen + 1}: ${turn ? "at" : "goes to"} ${shown(at.x)}, ${shown(at.y)} m.`);
    return true;
  }

  /* ---- Pictures ---- */

  draw() {
    const { width, height, cell_m, goal_x_m, goal_y_m } = this.view;
    this.plane.fit(0, 0, width * cell_m, height * cell_m);
    const context = this.plane.begin();
    this.plane.grid();
    this.drawGround(context);
    this.plane.line(this.path, css("plan"), 2);
    this.plane.line(this.trail, css("driven"), 2.5);
    this.plane.line(this.band, css("goal"), 3);
    context.fillStyle = css("driven");
    this.scan.forEach((point) => context.fillRect(this.plane.x(point.x) - 1, this.plane.y(point.y) - 1, 2, 2));
    this.plane.marker({ x: goal_x_m, y: goal_y_m }, 10, css("goal"), "G");
    this.drawPeople(context);
    this.drawRobot();
    this.drawTables();
  }

  drawGround(context) {
    const { width, height, cell_m } = this.view;
    const picture = (this.picture ??= document.createElement("canvas"));
    if (this.painted !== this.cells || this.paintedDark !== css("wall")) {
      this.painted = this.cells;
      this.paintedDark = css("wall");
      picture.width = width;
      picture.height = height;
      const brush = picture.getContext("2d");
      const image = brush.createImageData(width, height);
      const colours = [null, colourOf("wall"), colourOf("unknown")];
      this.cells.forEach((cell, i) => {
        const at = 4 * ((height - 1 - Math.floor(i / width)) * width + (i % width));
        image.data.set(colours[cell] ? [...colours[cell], 255] : [0, 0, 0, 0], at);
      });
      brush.putImageData(image, 0, 0);
    }
    context.imageSmoothingEnabled = false;
    context.drawImage(picture, this.plane.x(0), this.plane.y(height * cell_m), width * cell_m * this.plane.scale, height * cell_m * this.plane.scale);
  }

  drawPeople(context) {
    this.shapes.forEach((shape, i) => {
      const target = this.held === i && this.wanted ? this.wanted : this.targets.get(i);
      if (target) {
        this.plane.line([shape, target], css("person"), 1.5, [3, 4]);
      }
      if (shape.radius === 0) {
        context.fillStyle = css("person");
        context.fillRect(this.plane.x(shape.x) - 5, this.plane.y(shape.y) - 5, 10, 10);
      } else {
        this.plane.marker(shape, Math.max(9, shape.radius * this.plane.scale), css("person"), `${i + 1}`, i === this.chosen ? css("driven") : null);
      }
    });
  }

  drawRobot() {
    const view = this.view;
    const { length_m, width_m, wheelbase_m, track_m } = view;
    this.plane.at({ x: view.x_m, y: view.y_m, heading: view.heading_rad }, width_m, 10, (context) => {
      context.fillStyle = css("plan");
      context.globalAlpha = 0.8;
      context.fillRect(-length_m / 2, -width_m / 2, length_m, width_m);
      context.globalAlpha = 1;
      context.fillStyle = css("ink");
      for (const [end, side, angle] of [[1, 1, view.wheel_angle_front_left_rad], [1, -1, view.wheel_angle_front_right_rad], [-1, 1, view.wheel_angle_rear_left_rad], [-1, -1, view.wheel_angle_rear_right_rad]]) {
        context.save();
        context.translate((end * wheelbase_m) / 2, (side * track_m) / 2);
        context.rotate(angle);
        context.fillRect(-0.09, -0.03, 0.18, 0.06);
        context.restore();
      }
      context.fillStyle = css("driven");
      context.beginPath();
      context.moveTo(length_m / 2, 0);
      context.lineTo(length_m / 2 - 0.18, 0.1);
      context.lineTo(length_m / 2 - 0.18, -0.1);
      context.fill();
    });
  }

  drawTables() {
    const view = this.view;
    const rows = [
      ["robot", this.core.text(this.core.exports.patrol_state_name())],
      ["speed", `${shown(view.speed_m_s, 2)} m/s`],
      ["nearest now", `${shown(view.clearance_m, 2)} m`],
      ["nearest so far", `${shown(view.clearance_min_m, 2)} m`],
      ["planned anew", shown(view.replans, 0)],
      ["driven", `${shown(view.driven_m, 2)} m`],
      ["error of the pose that it believes", `${shown(100 * Math.hypot(view.x_m - view.believed_x_m, view.y_m - view.believed_y_m), 1)} cm`],
    ];
    const text = JSON.stringify(rows);
    if (text !== this.tableText) {
      this.tableText = text;
      fillTable(this.table, ["", ""], rows);
    }
    const { forecast_j, deviation_j, time_s } = view;
    const known = Number.isFinite(forecast_j);
    const bounds = known ? [forecast_j - 1.96 * deviation_j, forecast_j + 1.96 * deviation_j] : [];
    this.chart.draw([
      { points: this.spent, colour: css("driven") },
      { points: known ? [[0, forecast_j], [Math.max(time_s, 1), forecast_j]] : [], colour: css("plan") },
      ...bounds.map((energy) => ({ points: [[0, energy], [Math.max(time_s, 1), energy]], colour: css("plan"), dash: [5, 5] })),
    ]);
  }
}
