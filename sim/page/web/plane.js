"use strict";
/* Drawing in metres, and charts with axes. */

const css = (name) => getComputedStyle(document.documentElement).getPropertyValue(`--${name}`).trim();

/** Red, green and blue, 0…255. */
function colourOf(name) {
  return [1, 3, 5].map((at) => parseInt(css(name).slice(at, at + 2), 16));
}

/** A round step of which about `count` fit into a range. */
function roundStep(range, count) {
  const raw = range / count;
  const power = 10 ** Math.floor(Math.log10(raw));
  return [1, 2, 5, 10].map((factor) => factor * power).find((step) => step >= raw);
}

/** Sharp on any screen; the context draws in CSS pixels. */
function prepareCanvas(canvas) {
  const ratio = window.devicePixelRatio || 1;
  const width = canvas.clientWidth;
  const height = canvas.clientHeight;
  if (canvas.width !== Math.round(width * ratio) || canvas.height !== Math.round(height * ratio)) {
    canvas.width = Math.round(width * ratio);
    canvas.height = Math.round(height * ratio);
  }
  const context = canvas.getContext("2d");
  context.setTransform(ratio, 0, 0, ratio, 0, 0);
  context.clearRect(0, 0, width, height);
  context.font = "13px system-ui, sans-serif";
  context.lineJoin = "round";
  return { context, width, height };
}

/** A window of the plane, north up, that shows a rectangle of it whole. */
class Plane {
  constructor(canvas) {
    this.canvas = canvas;
    this.margin = 34;
    this.box = { left: 0, bottom: 0, right: 1, top: 1 };
  }

  /** What is to be seen, m. */
  fit(left, bottom, right, top) {
    this.box = { left, bottom, right, top };
  }

  begin() {
    Object.assign(this, prepareCanvas(this.canvas));
    const { left, bottom, right, top } = this.box;
    this.scale = Math.min((this.width - 2 * this.margin) / (right - left), (this.height - 2 * this.margin) / (top - bottom));
    this.originX = this.width / 2 - (this.scale * (left + right)) / 2;
    this.originY = this.height / 2 + (this.scale * (bottom + top)) / 2;
    return this.context;
  }

  x(metres) { return this.originX + metres * this.scale; }
  y(metres) { return this.originY - metres * this.scale; }

  /** Where on the plane a pointer is. */
  place(event) {
    const box = this.canvas.getBoundingClientRect();
    return { x: (event.clientX - box.left - this.originX) / this.scale, y: (this.originY - event.clientY + box.top) / this.scale };
  }

  grid() {
    const { context } = this;
    const step = roundStep(this.width / this.scale, Math.max(3, this.width / 110));
    context.lineWidth = 1;
    context.strokeStyle = css("grid");
    context.fillStyle = css("faint");
    context.textAlign = "center";
    for (let i = Math.ceil(-this.originX / this.scale / step); this.x(i * step) < this.width; i++) {
      this.stroke([[this.x(i * step), 0], [this.x(i * step), this.height]]);
      context.fillText(`${+(i * step).toFixed(2)} m`, this.x(i * step), this.height - 6);
    }
    context.textAlign = "left";
    for (let i = Math.ceil((this.originY - this.height) / this.scale / step); this.y(i * step) > 0; i++) {
      this.stroke([[0, this.y(i * step)], [this.width, this.y(i * step)]]);
      if (this.y(i * step) < this.height - 24) {
        context.fillText(`${+(i * step).toFixed(2)} m`, 4, this.y(i * step) - 3);
      }
    }
  }

  stroke(points) {
    this.context.beginPath();
    points.forEach(([x, y]) => this.context.lineTo(x, y));
    this.context.stroke();
  }

  /** Through places in m. */
  line(places, colour, width = 2, dash = []) {
    const { context } = this;
    context.strokeStyle = colour;
    context.lineWidth = width;
    context.setLineDash(dash);
    context.beginPath();
    places.forEach((place) => context.lineTo(this.x(place.x), this.y(place.y)));
    context.stroke();
    context.setLineDash([]);
  }

  /** A disc with a text in it; its radius in pixels. */
  marker(place, radius, fill, text, ring) {
    const { context } = this;
    context.beginPath();
    context.arc(this.x(place.x), this.y(place.y), radius, 0, 2 * Math.PI);
    context.fillStyle = fill;
    context.fill();
    if (ring) {
      context.strokeStyle = ring;
      context.lineWidth = 3;
      context.stroke();
    }
    context.fillStyle = css("on-accent");
    context.textAlign = "center";
    context.textBaseline = "middle";
    context.fillText(text, this.x(place.x), this.y(place.y) + 1);
    context.textBaseline = "alphabetic";
  }

  /** Draws in a frame whose x axis is a pose's heading, one unit a metre; `least` pixels make small things larger. */
  at(pose, size, least, draw) {
    const { context } = this;
    const scale = Math.max(this.scale, least / size);
    context.save();
    context.translate(this.x(pose.x), this.y(pose.y));
    context.rotate(-pose.heading);
    context.scale(scale, -scale);
    context.lineWidth = 1.5 / scale;
    draw(context);
    context.restore();
  }
}

/** A chart with labelled axes from 0. Each series: points [x, y], colour, and whether it is a line or dots. */
class Chart {
  constructor(canvas, xLabel, yLabel) {
    Object.assign(this, { canvas, xLabel, yLabel });
  }

  draw(series) {
    const { context, width, height } = prepareCanvas(this.canvas);
    const points = series.flatMap((one) => one.points);
    const most = (index) => (points.length > 0 ? Math.max(1e-9, ...points.map((point) => point[index])) * 1.06 : 1);
    const frame = { left: 52, right: width - 10, top: 30, bottom: height - 36 };
    const x = (value) => frame.left + ((frame.right - frame.left) * value) / most(0);
    const y = (value) => frame.bottom - ((frame.bottom - frame.top) * value) / most(1);
    this.axes(context, frame, most(0), most(1), x, y);
    for (const one of series) {
      context.strokeStyle = context.fillStyle = one.colour;
      context.lineWidth = 2;
      context.setLineDash(one.dash ?? []);
      context.beginPath();
      for (const [u, v] of one.points) {
        if (one.dots) {
          context.moveTo(x(u) + one.dots, y(v));
          context.arc(x(u), y(v), one.dots, 0, 2 * Math.PI);
        } else {
          context.lineTo(x(u), y(v));
        }
      }
      one.dots ? context.fill() : context.stroke();
      context.setLineDash([]);
    }
  }

  axes(context, frame, mostX, mostY, x, y) {
    context.fillStyle = css("faint");
    context.strokeStyle = css("line");
    context.lineWidth = 1;
    context.textAlign = "center";
    const stepX = roundStep(mostX, 5);
    for (let value = 0; value <= mostX; value += stepX) {
      context.strokeRect(x(value), frame.top, 0, frame.bottom - frame.top);
      context.fillText(+value.toFixed(3), x(value), frame.bottom + 14);
    }
    context.textAlign = "right";
    const stepY = roundStep(mostY, 4);
    for (let value = 0; value <= mostY; value += stepY) {
      context.strokeRect(frame.left, y(value), frame.right - frame.left, 0);
      context.fillText(+value.toFixed(3), frame.left - 5, y(value) + 4);
    }
    context.fillText(this.xLabel, frame.right, frame.bottom + 30);
    context.textAlign = "left";
    context.fillText(this.yLabel, 4, 14);
  }
}
