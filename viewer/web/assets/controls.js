/** Wire the panel on the left to an application. */
function wire(app) {
  const { data } = app;
  element("title").textContent = data.title;
  element("description").textContent = data.description;
  element("datum").textContent = `Places in ${data.crs}; water level at ${signed(data.waterLevel)} m.`;
  element("left-out").querySelector("ul").append(...data.leftOut.map((textContent) => make("li", { textContent })));
  const keyOf = (i) => (i < 10 ? `  (${(i + 1) % 10})` : "");
  element("attribute").append(...data.attributes.map(({ name, label }, i) => make("option", { value: name, textContent: label + keyOf(i) })));
  element("frame").max = data.flight.frame.length - 1;
  element("frame").value = data.flight.frame.length - 1;
  element("exaggeration").value = data.exaggeration;
  element("exaggeration").max = Math.max(20, data.exaggeration);
  const changes = {
    attribute: () => app.colour(),
    size: () => app.size(),
    exaggeration: () => app.exaggerate(),
    frame: () => app.goToFrame(),
    "only-frame": () => app.goToFrame(),
    "whole-gate": () => app.waveforms?.draw(),
  };
  for (const [id, act] of Object.entries(changes)) element(id).addEventListener("input", act);
  for (const name of Object.keys(app.shown)) element(`show-${name}`).addEventListener("input", () => app.toggle());
  element("reset").addEventListener("click", () => app.view.reset());
  element("above").addEventListener("click", () => app.view.lookFromAbove());
  element("next-mark").addEventListener("click", () => app.stepMark(1));
  element("close").addEventListener("click", () => app.closeWaveform());
}

const signed = (value) => (value < 0 ? "−" : "+") + Math.abs(value).toFixed(2);

/** Grey out what the page does not hold. */
function disable(id) {
  element(id).disabled = true;
  element(id).checked = false;
  element(id).closest("label")?.classList.add("absent");
}
