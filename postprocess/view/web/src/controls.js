// Pointer, wheel and keys.

const DRAG = 3; // pixels: less is a click

/** Calls `on.turn(dx, dy)`, `on.zoom(factor, x, y)`, `on.point(x, y)` and `on.leave()` in pixels of `stage`. */
export function followPointer(stage, on) {
  const down = new Map();
  const at = (event) => {
    const box = stage.getBoundingClientRect();
    return [event.clientX - box.left, event.clientY - box.top];
  };
  stage.addEventListener("pointerdown", (event) => {
    if (event.button !== 0) return;
    stage.setPointerCapture(event.pointerId);
    down.set(event.pointerId, at(event));
    on.point(...at(event)); // fingers do not hover
  });
  stage.addEventListener("pointermove", (event) => {
    const now = at(event);
    const before = down.get(event.pointerId);
    if (!before) return on.point(...now);
    if (down.size === 1) {
      on.turn(now[0] - before[0], now[1] - before[1]);
    } else {
      const [other] = [...down].filter(([id]) => id !== event.pointerId).map(([, place]) => place);
      const apart = (place) => Math.max(DRAG, Math.hypot(place[0] - other[0], place[1] - other[1]));
      on.zoom(apart(now) / apart(before), (now[0] + other[0]) / 2, (now[1] + other[1]) / 2);
    }
    down.set(event.pointerId, now);
    on.point(...now);
  });
  for (const name of ["pointerup", "pointercancel"]) stage.addEventListener(name, (event) => down.delete(event.pointerId));
  stage.addEventListener("pointerleave", () => on.leave());
  stage.addEventListener(
    "wheel",
    (event) => {
      event.preventDefault();
      const lines = event.deltaMode === 1 ? 30 : 1; // Firefox counts lines
      on.zoom(Math.exp(-0.0015 * lines * event.deltaY), ...at(event));
    },
    { passive: false },
  );
}

/** Calls `on.step(±1)`, `on.play()`, `on.turn(dx, dy)` and `on.zoom(factor)`, except where a control takes the key. */
export function followKeys(on) {
  const actions = {
    ArrowLeft: () => on.step(-1),
    ArrowRight: () => on.step(1),
    " ": () => on.play(),
    "+": () => on.zoom(1.3),
    "=": () => on.zoom(1.3),
    "-": () => on.zoom(1 / 1.3),
  };
  const turns = { ArrowLeft: [40, 0], ArrowRight: [-40, 0], ArrowUp: [0, 40], ArrowDown: [0, -40] };
  window.addEventListener("keydown", (event) => {
    if (event.ctrlKey || event.metaKey || event.altKey) return;
    const { tagName } = event.target;
    if (tagName === "SELECT" || tagName === "INPUT" || (tagName === "BUTTON" && event.key === " ")) return;
    const action = event.shiftKey && turns[event.key] ? () => on.turn(...turns[event.key]) : actions[event.key];
    if (!action) return;
    event.preventDefault();
    action();
  });
}
