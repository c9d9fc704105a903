const TURN = Math.PI / 36;
const MOVE = 0.08;
const ZOOM = 1.2;

/** Keys of the page; arrows and digits stay with a control that uses them itself. */
function listenToKeys(app) {
  const { view } = app;
  const arrow = (event, x, y) => (event.shiftKey ? view.move(MOVE * x, MOVE * y) : view.turn(TURN * x, TURN * y));
  const keys = {
    ArrowLeft: (event) => arrow(event, -1, 0),
    ArrowRight: (event) => arrow(event, 1, 0),
    ArrowUp: (event) => arrow(event, 0, 1),
    ArrowDown: (event) => arrow(event, 0, -1),
    "+": () => view.zoom(ZOOM),
    "=": () => view.zoom(ZOOM),
    "-": () => view.zoom(1 / ZOOM),
    "[": () => app.stepFrame(-1),
    "]": () => app.stepFrame(1),
    n: () => app.stepMark(1),
    p: () => app.stepMark(-1),
    t: () => view.lookFromAbove(),
    r: () => view.reset(),
    h: () => (element("help").open = !element("help").open),
    Escape: () => app.closeWaveform(),
  };
  app.data.attributes.slice(0, 10).forEach(({ name }, i) => (keys[(i + 1) % 10] = () => app.colour(name)));
  document.addEventListener("keydown", (event) => {
    const control = event.target.closest?.("input, select, button, summary");
    if (event.ctrlKey || event.metaKey || event.altKey) return;
    if (event.key === "Enter" && !control) return app.pickMiddle();
    if (control?.matches("select") && event.key.length === 1 && /[\w]/.test(event.key)) return;
    if (control?.matches("select, input[type=range]") && event.key.startsWith("Arrow")) return;
    if (!(event.key in keys)) return;
    event.preventDefault();
    keys[event.key](event);
  });
}
