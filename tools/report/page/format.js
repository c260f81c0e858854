// Numbers, names and units as text.
const subscripts = "₀₁₂₃₄₅₆₇₈₉";
const subscript = (n) => String(n).replace(/[0-9]/g, (digit) => subscripts[digit]);
const minus = (text) => text.replace(/-/g, "−");

// As JSON has it: a whole number keeps its ".0".
const asJson = (value) => {
  if (value === null || value === undefined || !Number.isFinite(value)) return "–";
  const text = String(value);
  return /^-?\d+$/.test(text) ? text + ".0" : text;
};

const significant = (value, digits) => {
  if (value === 0) return "0";
  const size = Math.abs(value);
  if (size >= 1e6 || size < 1e-4) {
    const [mantissa, exponent] = value.toExponential(Math.max(0, digits - 1)).split("e");
    const short = mantissa.includes(".") ? mantissa.replace(/\.?0+$/, "") : mantissa;
    return minus(short) + "·10" + Number(exponent).toString().replace(/-/, "⁻").replace(/[0-9]/g, (d) => "⁰¹²³⁴⁵⁶⁷⁸⁹"[d]);
  }
  const text = value.toPrecision(digits);
  return minus(text.includes("e") ? String(Number(text)) : text);
};

const short = (value, digits = 4) => {
  if (value === null || value === undefined || Number.isNaN(value)) return "–";
  if (!Number.isFinite(value)) return value > 0 ? "∞" : "−∞";
  const text = significant(value, digits);
  return text.includes(".") && !text.includes("·") ? text.replace(/\.?0+$/, "") : text;
};

// Digits as far as the error allows, 3 to 10.
const trustedDigits = (value, error) => {
  if (value === 0 || !(error < Math.abs(value))) return 3;
  if (error === 0) return 10;
  return Math.min(10, Math.max(3, Math.floor(Math.log10(Math.abs(value) / error)) + 1));
};
const errorText = (error) => (Number.isFinite(error) ? significant(error, 2) : "?");

// Units from the scene, as the tables of the command have them: forces in N, moments in N m.
const units = (() => {
  const u = report.units;
  return {
    length: u.length, time: u.time, rate: "1/" + u.time,
    response: isLinkage ? u.length : "",
    force: {factor: u.force_in_newton || 1, name: isLinkage ? "N" : ""},
    moment: {factor: u.torque_in_newton_metre || 1, name: "N m"},
    frequency: u.frequency || {factor: 1 / (2 * Math.PI * (u.time_in_s || 1)), name: "Hz"},
    degrees: u.angle === "deg" ? 1 : 180 / Math.PI,
  };
})();
const raised = (unit) => unit.replace(/\^(-?\d)/g, (_, digit) => digit.replace("-", "⁻").replace(/\d/, (d) => "⁰¹²³⁴⁵⁶⁷⁸⁹"[d]));
const withUnit = (name, unit) => (unit ? `${name} [${raised(unit)}]` : name);

const element = (tag, attributes = {}, ...children) => {
  const node = document.createElement(tag);
  for (const [key, value] of Object.entries(attributes)) {
    if (key === "class") node.className = value;
    else if (key.startsWith("on")) node.addEventListener(key.slice(2), value);
    else if (value !== null && value !== undefined && value !== false) node.setAttribute(key, value === true ? "" : value);
  }
  for (const child of children.flat()) if (child !== null && child !== undefined) node.append(child);
  return node;
};
const clear = (node) => { while (node.firstChild) node.removeChild(node.firstChild); };
