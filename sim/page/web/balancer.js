"use strict";
/* A balancing robot that drives through waypoints that one drags. */

class BalancerScene {
  static title = "Balancer";

  constructor(core, canvas, say) {
    Object.assign(this, { core, say });
    this.plane = new Plane(canvas);
    this.seed = 1;
    this.waypoints = [{ x: 4, y: 0 }, { x: 7, y: 3 }, { x: 4, y: 6 }, { x: 0, y: 4 }];
    this.robots = Array.from({ length: core.exports.balancer_robots() },
      (_, i) => core.text(core.exports.balancer_robot_name(i)));
    this.robot = Math.max(0, this.robots.indexOf("gao2018"));
  }

  /** Parts of a link. */
  link() {
    return { robot: this.robots[this.robot], seed: this.seed, way: this.waypoints.map(({ x, y }) => `${+x.toFixed(2)},${+y.toFixed(2)}`).join(";") };
  }

  follow(link) {
    const robot = this.robots.indexOf(link.get("robot"));
    const way = (link.get("way") ?? "").split(";").map((text) => text.split(",").map(Number));
    this.robot = robot < 0 ? this.robot : robot;
    this.seed = Math.max(1, Math.floor(Number(link.get("seed"))) || this.seed);
    if (way.length > 0 && way.length <= 32 && way.every((place) => place.length === 2 && place.every((value) => Math.abs(value) <= 100))) {
      this.waypoints = way.map(([x, y]) => ({ x, y }));
    }
  }

  get labels() {
    return { help: "Map of waypoints. Arrow keys move the chosen waypoint; Page up and Page down choose another." };
  }

  /* ---- Panel ---- */

  build(panel, below) {
    this.places = new Places(this.waypoints, (i) => `waypoint ${i + 1}`, () => this.change());
    this.table = make("table", { id: "legs" });
    this.push = slider("Push", "push", 1, 40, 1, 8, "N");
    this.front = make("canvas", { className: "chart", id: "front", role: "img", "aria-label": "Energy over time of the route: what slower and faster drives take, and this drive" });
    this.within = make("input", { type: "number", id: "within", min: 1, max: 1000, step: 1, "aria-label": "seconds in which the route shall be driven" });
    this.side = make("canvas", { className: "side", id: "side", role: "img", "aria-label": "The robot from its side" });
    this.chart = new Chart(this.front, "time, s", "energy, J");
    panel.replaceChildren(
      section("Robot", choice("Robot", "robot", this.robots.map((name, i) => [i, name]), this.robot, (value) => { this.robot = Number(value); this.reset(); })),
      section("Waypoints", this.places.element, make("div", { className: "row" },
        button("Add", "add", () => this.add()),
        button("Drive", "drive", () => this.drive(), { className: "primary" }),
        button("Brake", "brake", () => { this.core.exports.balancer_stop(); this.say("It brakes."); })),
      make("p", { className: "hint" }, "Drag a waypoint on the map, or type. A change while it drives holds from the next waypoint on.")),
      section("Disturb it", this.push.element, make("div", { className: "row" },
        button("Push back", "push-back", () => this.shove(-1)), button("Push forward", "push-forward", () => this.shove(1)),
        make("span", { className: "hint" }, "for 0.2 s at its centre of mass")), this.side));
    below.replaceChildren(
      section("Joules against time", this.front, make("div", { className: "row" }, make("label", { className: "row" }, "Within", this.within), "s",
        button("Drive within", "drive-within", () => this.driveWithin())),
        legend(["line", "plan", "what the route takes at each cruise, foretold from where it starts"], ["line", "driven", "this drive"])),
      section("Legs", this.table, (this.noLegs = make("p", { className: "hint" }, "Drive sends it: then each leg's joules are here, planned and driven."))));
  }

  add() {
    const last = this.waypoints[this.waypoints.length - 1];
    this.waypoints.push({ x: last.x + 2, y: last.y });
    this.places.show();
    this.change();
  }

  shove(direction) {
    this.core.exports.balancer_push(direction * this.push.value, Math.round(0.2 * this.core.exports.balancer_ticks_a_second()));
    this.say(`Pushed ${direction > 0 ? "forward" : "back"} with ${this.push.value} N for 0.2 s.`);
  }

  /* ---- Drive ---- */

  reset() {
    if (!this.core.exports.balancer_reset(this.robot, this.seed)) {
      this.say(this.core.error);
    }
    this.trail = [];
    this.spent = [[0, 0]];
    this.isWithin = false;
    this.begun = 0; // the first waypoint of the route that is followed
    this.view = this.core.view("balancer");
    this.foretell();
    this.say("It balances. Drive sends it along the waypoints.");
  }

  /** What the route takes from where the robot stands, at each cruise. */
  foretell() {
    const route = this.remaining();
    route.forEach(({ x, y }) => this.core.exports.balancer_add(x, y));
    const count = this.core.exports.balancer_front();
    const numbers = this.core.doubles(this.core.exports.balancer_front_points(), 3 * count);
    this.points = Array.from({ length: count }, (_, i) => [numbers[3 * i + 1], numbers[3 * i + 2]]);
    if (count > 0 && document.activeElement !== this.within) {
      this.within.value = Math.ceil(1.05 * this.points[count - 1][0]); // of the fastest
    }
  }

  remaining() {
    return this.view.is_driving ? this.waypoints.slice(Math.min(this.begun + this.view.leg + 1, this.waypoints.length - 1)) : this.waypoints;
  }

  drive() {
    this.view = this.core.view("balancer");
    const route = this.remaining();
    this.begun = this.waypoints.length - route.length;
    if (!this.view.is_driving) {
      this.foretell();
      this.trail = [];
    }
    this.spent = [[0, 0]];
    this.isWithin = false;
    route.forEach(({ x, y }) => this.core.exports.balancer_add(x, y));
    const status = this.core.exports.balancer_follow();
    this.view = this.core.view("balancer");
    this.over = false;
    this.say(status === 0 ? `Under way over ${route.length} waypoints.` : `It cannot follow: ${Core.reason(status)}.`);
  }

  /** As fast as is asked for, and for no more energy than that takes. */
  driveWithin() {
    const seconds = this.within.valueAsNumber;
    this.foretell();
    this.waypoints.forEach(({ x, y }) => this.core.exports.balancer_add(x, y));
    const status = Number.isFinite(seconds) ? this.core.exports.balancer_drive_within(seconds) : -1;
    if (status === -3) {
      this.say(`It takes ${shown(Math.ceil(10 * this.core.exports.balancer_within_needs()) / 10)} s at least.`);
    } else if (status !== 0) {
      this.say(status === -7 ? "It drives: brake first, or wait until it stands." : `It cannot follow: ${Core.reason(status)}.`);
    } else {
      this.begun = 0;
      this.trail = [];
      this.spent = [[0, 0]];
      this.over = false;
      this.isWithin = true;
      this.say(`Under way within ${shown(seconds)} s, for ${shown(this.core.exports.balancer_within_forecast())} J.`);
    }
  }

  change() {
    if (this.view.is_driving && !this.isWithin) {
      this.drive();
    } else {
      this.foretell();
    }
  }

  /** So many seconds. */
  run(seconds) {
    const rate = this.core.exports.balancer_ticks_a_second();
    const chunk = Math.max(1, Math.round(rate / 20));
    this.due = (this.due ?? 0) + seconds * rate;
    while (this.due >= 1) {
      const ticks = Math.min(chunk, Math.floor(this.due));
      if (this.core.exports.balancer_run(ticks) < ticks) {
        this.due = 0;
        break;
      }
      this.due -= ticks;
      this.view = this.core.view("balancer");
      this.note();
    }
    this.view = this.core.view("balancer");
    this.report();
  }

  note() {
    const { x_m: x, y_m: y, driven_s: time, driven_j: joules } = this.view;
    const last = this.trail[this.trail.length - 1];
    if (!last || Math.hypot(x - last.x, y - last.y) > 0.02) {
      this.trail.push({ x, y });
    }
    if (time > this.spent[this.spent.length - 1][0]) {
      this.spent.push([time, joules]);
    }
  }

  report() {
    const view = this.view;
    if (view.has_fallen) {
      this.say("It fell. Reset stands it up again.");
    } else if (view.faults) {
      this.say(`It has stopped: ${this.core.text(this.core.exports.balancer_faults())}. Reset starts anew.`);
    } else if (view.status < 0) {
      this.say(`The route ended: ${Core.reason(view.status)}.`);
    } else if (!this.over && view.leg_count > 0 && view.leg === view.leg_count && !view.is_driving) {
      this.over = true;
      this.say(`There: ${shown(view.driven_j, 2)} J of ${shown(this.forecast(), 2)} J foretold.`);
    }
  }

  forecast() {
    return this.isWithin ? this.core.exports.balancer_within_forecast() : this.view.forecast_j;
  }

  gauges() {
    const { deviation_j, driven_j, drawn_j, capacity_j, time_s } = this.view;
    const forecast_j = this.forecast();
    return { forecast: this.isWithin ? `${shown(forecast_j)} J <small>within a time: no interval</small>` : interval(forecast_j, deviation_j), driven: `${shown(driven_j, 2)} J`, battery: battery(drawn_j, capacity_j), time: `${shown(time_s)} s` };
  }

  /* ---- Hands ---- */

  /** The waypoint at a place, or nothing. */
  pick(place) {
    const near = (at) => Math.hypot(at.x - place.x, at.y - place.y) * this.plane.scale;
    const nearest = this.waypoints.reduce((best, at) => (near(at) < near(best) ? at : best));
    return near(nearest) < 24 ? this.waypoints.indexOf(nearest) : -1;
  }

  press(place) {
    this.chosen = this.pick(place);
    this.held = this.chosen;
  }

  drag(place) {
    if (this.held >= 0) {
      this.waypoints[this.held] = { x: Math.round(place.x * 10) / 10, y: Math.round(place.y * 10) / 10 };
      this.places.show();
      if (!this.view.is_driving) {
        this.foretell();
      }
    }
  }

  release() {
    if (this.held >= 0) {
      this.held = -1;
      this.change();
    }
  }

  key(name) {
    const move = { ArrowLeft: [-0.5, 0], ArrowRight: [0.5, 0], ArrowUp: [0, 0.5], ArrowDown: [0, -0.5] }[name];
    const turn = { PageDown: 1, PageUp: -1 }[name];
    const count = this.waypoints.length;
    this.chosen = Math.max(0, Math.min(this.chosen ?? 0, count - 1));
    if (turn) {
      this.chosen = (this.chosen + turn + count) % count;
    } else if (move) {
      this.waypoints[this.chosen].x += move[0];
      this.waypoints[this.chosen].y += move[1];
      this.places.show();
      this.change();
    } else {
      return false;
    }
    const { x, y } = this.waypoints[this.chosen];
    this.say(`Waypoint ${this.chosen + 1} at ${shown(x)}, ${shown(y)} m.`);
    return true;
  }

  /* ---- Pictures ---- */

  draw() {
    if (!(this.held >= 0)) {
      this.frame();
    }
    this.plane.begin();
    this.plane.grid();
    this.plane.line([{ x: 0, y: 0 }, ...this.waypoints], css("plan"), 1.5, [6, 5]);
    this.plane.line(this.trail, css("driven"), 2.5);
    this.waypoints.forEach((place, i) => this.plane.marker(place, 12, css("plan"), `${i + 1}`, i === this.chosen ? css("driven") : null));
    this.drawRobot();
    this.drawSide();
    this.chart.draw([{ points: this.points, colour: css("plan") }, { points: this.spent, colour: css("driven") }, { points: this.spent.slice(-1), colour: css("driven"), dots: 4 }]);
    this.drawLegs();
  }

  frame() {
    const places = [...this.waypoints, { x: 0, y: 0 }, { x: this.view.x_m, y: this.view.y_m }];
    const xs = places.map((place) => place.x);
    const ys = places.map((place) => place.y);
    this.plane.fit(Math.min(...xs) - 0.5, Math.min(...ys) - 0.5, Math.max(...xs) + 0.5, Math.max(...ys) + 0.5);
  }

  drawRobot() {
    const { x_m, y_m, heading_rad, width_m, radius_m } = this.view;
    this.plane.at({ x: x_m, y: y_m, heading: heading_rad }, width_m, 26, (context) => {
      context.fillStyle = css("ink");
      for (const side of [-1, 1]) {
        context.fillRect(-radius_m, (side * width_m) / 2 - 0.06 * width_m, 2 * radius_m, 0.12 * width_m);
      }
      context.fillStyle = css("driven");
      context.beginPath();
      context.moveTo(0.5 * width_m, 0);
      context.lineTo(-0.25 * width_m, 0.35 * width_m);
      context.lineTo(-0.25 * width_m, -0.35 * width_m);
      context.fill();
    });
  }

  drawSide() {
    const { context, width, height } = prepareCanvas(this.side);
    const { pitch_rad, wheel_rad, radius_m, centre_height_m, push_n, speed_m_s } = this.view;
    const scale = (height - 34) / (radius_m + 2 * centre_height_m);
    const ground = height - 8;
    context.strokeStyle = css("line");
    context.lineWidth = 2;
    context.strokeRect(0, ground, width, 0);
    context.save();
    context.translate(width / 2, ground - radius_m * scale);
    context.save();
    context.rotate(pitch_rad);
    context.fillStyle = css("plan");
    context.fillRect(-0.16 * radius_m * scale - 4, -2 * centre_height_m * scale, 0.32 * radius_m * scale + 8, 2 * centre_height_m * scale);
    context.restore();
    context.rotate(wheel_rad);
    context.strokeStyle = css("ink");
    context.lineWidth = 3;
    context.beginPath();
    context.arc(0, 0, radius_m * scale - 2, 0, 2 * Math.PI);
    context.moveTo(0, 0);
    context.lineTo(0, -radius_m * scale + 2);
    context.stroke();
    context.restore();
    context.fillStyle = css("faint");
    context.textAlign = "left";
    context.fillText(`pitch ${shown((pitch_rad * 180) / Math.PI, 2)}°`, 8, 18);
    context.fillText(`speed ${shown(speed_m_s, 2)} m/s`, 8, 36);
    if (push_n !== 0) {
      context.fillStyle = css("driven");
      context.fillText(`push ${shown(push_n, 0)} N ${push_n > 0 ? "→" : "←"}`, 8, 54);
    }
  }

  drawLegs() {
    const count = this.view.leg_count;
    const numbers = this.core.doubles(this.core.exports.balancer_legs(), 3 * count);
    const rows = Array.from({ length: count }, (_, i) => [`${this.begun + i + 1}${i === this.view.leg && this.view.is_driving ? " ◂" : ""}`,
      shown(numbers[3 * i]), i <= this.view.leg ? shown(numbers[3 * i + 1]) : "–", i <= this.view.leg ? shown(numbers[3 * i + 2]) : "–"]);
    const text = JSON.stringify(rows);
    if (text !== this.tableText) {
      this.tableText = text;
      this.noLegs.hidden = count > 0;
      fillTable(this.table, ["to", "planned J", "driven J", "time s"], rows);
    }
  }
}

/** What is left, by what the meter has counted since the battery was full. */
function battery(drawn, capacity) {
  const left = capacity - drawn;
  return `${shown((100 * left) / capacity, 2)} % <small>${shown(left / 3600, 2)} Wh left</small>`;
}
