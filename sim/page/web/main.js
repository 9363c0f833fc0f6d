"use strict";
/* The page: scenes, the clock, gauges, links. */

const scenes = { balancer: BalancerScene, planner: PlannerScene, patrol: PatrolScene };
const element = (id) => document.getElementById(id);

class Page {
  constructor(core) {
    this.core = core;
    this.plane = element("plane");
    this.isPaused = false;
    this.instances = {};
    this.connect();
    this.open();
    window.addEventListener("hashchange", () => this.open());
    requestAnimationFrame((time) => this.frame(time));
  }

  say(text) {
    if (text && element("message").textContent !== text) {
      element("message").textContent = text;
    }
  }

  /* ---- Links ---- */

  /** The scene that the address names. */
  open() {
    const link = new URLSearchParams(location.hash.slice(1));
    const name = link.get("scene") in scenes ? link.get("scene") : "balancer";
    this.show(name, link);
    if (link.has("speed")) {
      element("speed").value = link.get("speed");
      element("speed").value ||= "1";
    }
  }

  address() {
    const link = new URLSearchParams({ scene: this.name, ...this.scene.link(), speed: element("speed").value });
    return `${location.href.split("#")[0]}#${link}`;
  }

  async copy() {
    history.replaceState(null, "", this.address());
    try {
      await navigator.clipboard.writeText(this.address());
      this.say("The link to this scene is copied.");
    } catch {
      this.say("The link to this scene is in the address bar.");
    }
  }

  /* ---- Scenes ---- */

  show(name, link = new URLSearchParams()) {
    this.name = name;
    this.scene = this.instances[name] ??= new scenes[name](this.core, this.plane, (text) => this.say(text));
    this.scene.follow(link);
    document.querySelectorAll("[role=tab]").forEach((tab) => {
      tab.setAttribute("aria-selected", tab.dataset.scene === name);
      tab.tabIndex = tab.dataset.scene === name ? 0 : -1;
    });
    element("scene").setAttribute("aria-labelledby", `tab-${name}`);
    this.scene.build(element("panel"), element("below"));
    this.plane.setAttribute("aria-label", this.scene.labels.help);
    this.scene.reset();
  }

  pause(isPaused) {
    this.isPaused = isPaused;
    element("pause").textContent = isPaused ? "Go on" : "Pause";
    element("pause").setAttribute("aria-pressed", isPaused);
  }

  /* ---- Hands ---- */

  connect() {
    element("pause").onclick = () => this.pause(!this.isPaused);
    element("reset").onclick = () => this.scene.reset();
    element("link").onclick = () => this.copy();
    const tabs = [...document.querySelectorAll("[role=tab]")];
    tabs.forEach((tab, i) => {
      tab.onclick = () => { history.replaceState(null, "", location.href.split("#")[0]); this.show(tab.dataset.scene); };
      tab.onkeydown = (event) => {
        const step = { ArrowRight: 1, ArrowLeft: -1 }[event.key];
        if (step) {
          const next = tabs[(i + step + tabs.length) % tabs.length];
          next.focus();
          next.click();
        }
      };
    });
    this.plane.onpointerdown = (event) => {
      this.plane.setPointerCapture(event.pointerId);
      this.plane.focus({ preventScroll: true });
      this.scene.press(this.scene.plane.place(event), event);
    };
    this.plane.onpointermove = (event) => {
      if (event.buttons !== 0) {
        this.scene.drag(this.scene.plane.place(event), event);
      }
    };
    this.plane.onpointerup = this.plane.onpointercancel = () => this.scene.release();
    this.plane.onkeydown = (event) => {
      if (event.key === " ") {
        this.pause(!this.isPaused);
        event.preventDefault();
      } else if (this.scene.key(event.key)) {
        event.preventDefault();
      }
    };
  }

  /* ---- Time ---- */

  frame(time) {
    const passed = Math.min(0.1, (time - (this.time ?? time)) / 1000);
    this.time = time;
    if (!this.isPaused) {
      this.scene.run(passed * Number(element("speed").value));
    }
    this.scene.draw();
    for (const [name, text] of Object.entries(this.scene.gauges())) {
      const gauge = element(`gauge-${name}`);
      if (gauge.innerHTML !== text) {
        gauge.innerHTML = text;
      }
    }
    if (performance.getEntriesByName("first frame").length === 0) {
      performance.mark("first frame");
    }
    requestAnimationFrame((next) => this.frame(next));
  }
}

Core.load(coreWasm).then((core) => { window.page = new Page(core); });
