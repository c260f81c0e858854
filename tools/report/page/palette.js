// Colours of the style sheet, for what is drawn on canvases; read anew when the scheme changes or the page is printed.
let colours = {};
const readColours = () => {
  const style = getComputedStyle(document.documentElement);
  colours = new Proxy({}, {
    get: (known, name) => known[name] || (known[name] = style.getPropertyValue("--" + name).trim()),
  });
};
readColours();
const modeColour = (i) => colours["c" + (1 + (i % 7))];

// Growth as colour on a map: blue where disturbances die out, white at zero, red where they grow.
const diverging = [
  [-1, 33, 102, 172], [-0.5, 103, 169, 207], [-0.12, 209, 229, 240], [0, 247, 247, 247], [0.12, 253, 219, 199],
  [0.5, 239, 138, 98], [1, 178, 24, 43],
];
const growthColour = (t) => {
  const v = Math.max(-1, Math.min(1, t));
  let k = 1;
  while (k < diverging.length - 1 && v > diverging[k][0]) ++k;
  const a = diverging[k - 1], b = diverging[k], share = (v - a[0]) / (b[0] - a[0]);
  return [1, 2, 3].map((c) => Math.round(a[c] + share * (b[c] - a[c])));
};

// Of those colours a bar from 1 above to -1 below.
const growthBar = (pen, left, top, width, height) => {
  const fill = pen.createLinearGradient(0, top, 0, top + height);
  for (const [at, r, g, b] of diverging) fill.addColorStop((1 - at) / 2, `rgb(${r},${g},${b})`);
  pen.fillStyle = fill;
  pen.fillRect(left, top, width, height);
};
