// The state in the URL's fragment, so that a link shows what its sender saw.
const readFragment = () => {
  const given = new URLSearchParams(location.hash.slice(1));
  const number = (key) => (given.has(key) && given.get(key) !== "" && Number.isFinite(Number(given.get(key))) ? Number(given.get(key)) : null);
  if (number("speed") !== null && points.count > 0) state.index = Math.max(0, Math.min(points.count - 1, Math.round(number("speed"))));
  if (number("angle") !== null) state.angle = (number("angle") * Math.PI) / 180;
  if (number("magnification") > 0) state.magnification = number("magnification");
  if (number("pace") > 0) state.secondsPerTurn = number("pace");
  if (number("band") > 0) state.band = Math.round(number("band"));
  if (number("fibre") !== null) state.fibre = Math.sign(number("fibre"));
  if (given.has("joint")) state.joint = given.get("joint");
  if (given.has("play")) state.wantsPlay = given.get("play") === "1";
  const zoom = (given.get("zoom") || "").split(":").map(Number);
  if (zoom.length === 2 && zoom.every(Number.isFinite) && zoom[0] < zoom[1]) state.zoom = zoom;
  const node = (given.get("map") || "").split(":").map(Number);
  if (given.has("map") && node.length === 2 && node.every(Number.isInteger)) state.mapNode = node;
};

let fragmentTimer = 0;
const writeFragment = () => {
  clearTimeout(fragmentTimer);
  fragmentTimer = setTimeout(() => {
    const text = new URLSearchParams();
    text.set("speed", state.index);
    if (!state.playing) text.set("angle", Math.round((state.angle * 180) / Math.PI));
    text.set("play", state.playing ? 1 : 0);
    text.set("magnification", state.magnification);
    text.set("pace", state.secondsPerTurn);
    if (state.band) text.set("band", state.band);
    if (state.fibre) text.set("fibre", state.fibre);
    if (state.joint) text.set("joint", state.joint);
    if (state.zoom) text.set("zoom", state.zoom.join(":"));
    if (state.mapNode) text.set("map", state.mapNode.join(":"));
    try {
      history.replaceState(null, "", "#" + text);
    } catch (refused) {
      // Some browsers refuse that for files; the page works without.
    }
  }, 300);
};

// Another address put into the same window is shown; a link within the page leaves the address as it was.
window.addEventListener("hashchange", () => { if (location.hash.includes("speed=")) location.reload(); else writeFragment(); });
