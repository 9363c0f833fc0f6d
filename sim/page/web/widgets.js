"use strict";
/* Parts of the panel. Everything in it is plain HTML that a keyboard and a screen reader reach. */

/** make("button", {id, onclick, …}, child, …): attributes that are properties are set as such. */
function make(tag, attributes = {}, ...children) {
  const element = document.createElement(tag);
  for (const [name, value] of Object.entries(attributes)) {
    if (name in element) {
      element[name] = value;
    } else {
      element.setAttribute(name, value);
    }
  }
  element.append(...children);
  return element;
}

const button = (text, id, onclick, attributes = {}) => make("button", { id, onclick, type: "button", ...attributes }, text);

function section(title, ...children) {
  return make("section", {}, make("h2", {}, title), ...children);
}

/** What is drawn how: [kind, name of its colour, text], where a kind is area, line, dashed or dotted. */
function legend(...entries) {
  return make("ul", { className: "legend" }, ...entries.map(([kind, colour, text]) =>
    make("li", {}, make("span", { className: `swatch ${kind} ${colour}`, style: `color: var(--${colour})` }), text)));
}

function choice(label, id, options, value, onchange) {
  const select = make("select", { id, onchange: () => onchange(select.value) },
    ...options.map(([key, text]) => make("option", { value: key }, text)));
  select.value = value;
  return make("label", { className: "row" }, label, select);
}

function slider(label, id, least, most, step, value, unit, onchange) {
  const shown = make("output", { htmlFor: id });
  const input = make("input", { type: "range", id, min: least, max: most, step, value });
  const show = () => { shown.textContent = `${input.value} ${unit}`; };
  input.oninput = () => { show(); onchange?.(Number(input.value)); };
  show();
  return { element: make("label", { className: "row" }, label, input, shown), get value() { return Number(input.value); } };
}

/** A list of places with a number field for each coordinate. */
class Places {
  constructor(places, names, onchange, keepsAll = false) {
    Object.assign(this, { places, names, onchange, keepsAll });
    this.element = make("ol", { className: "places" });
    this.show();
  }

  show() {
    if (this.element.contains(document.activeElement) && document.activeElement.tagName === "INPUT"
        && this.element.childElementCount === this.places.length) {
      this.update();
      return;
    }
    this.element.replaceChildren(...this.places.map((place, i) => this.row(place, i)));
  }

  update() {
    this.element.querySelectorAll("input").forEach((input) => {
      if (input !== document.activeElement) {
        input.value = this.places[input.dataset.index][input.dataset.axis].toFixed(1);
      }
    });
  }

  row(place, index) {
    const field = (axis) => {
      const input = make("input", {
        type: "number", step: "0.5", value: place[axis].toFixed(1), "aria-label": `${this.names(index)}, ${axis} in metres`,
        onchange: () => {
          if (Number.isFinite(input.valueAsNumber)) {
            this.places[index][axis] = input.valueAsNumber;
            this.onchange();
          }
        },
      });
      input.dataset.index = index;
      input.dataset.axis = axis;
      return input;
    };
    const remove = button("×", "", () => { this.places.splice(index, 1); this.show(); this.onchange(); },
      { "aria-label": `remove ${this.names(index)}`, disabled: this.places.length < 2 });
    return make("li", {}, make("span", {}, `${index + 1}`), "x", field("x"), "y", field("y"), "m", ...(this.keepsAll ? [] : [remove]));
  }
}

/** Rows of text under a head. */
function fillTable(table, head, rows) {
  const row = (tag, cells) => make("tr", {}, ...cells.map((cell) => make(tag, {}, cell)));
  table.replaceChildren(make("thead", {}, row("th", head)), make("tbody", {}, ...rows.map((cells) => row("td", cells))));
}

/** A number with as many digits as people read; a dash for what is not known. */
function shown(value, digits = 1) {
  return Number.isFinite(value) ? value.toFixed(digits).replace(/^-(0(\.0*)?)$/, "$1") : "–";
}

/** An expectation with the interval of 95 %. */
function interval(energy, deviation) {
  if (!Number.isFinite(energy)) {
    return "–";
  }
  return `${shown(energy)} J <small>±\u00a0${shown(1.96 * deviation)}\u00a0J (95\u00a0%)</small>`;
}

/** Of a battery whose capacity no file tells. */
function drawn(joules, volts) {
  return `${shown(joules / 3600, 2)} Wh drawn <small>at ${shown(volts)} V</small>`;
}
