// Tables, their cells, and the mark of a check.

function table(heads, rows) {
  return element("div", { class: "scroll" }, element("table", {}, element("thead", {}, element("tr", {}, heads.map((head) => element("th", {}, head)))), element("tbody", {}, rows)));
}

const row = (cells, attributes = {}) => element("tr", attributes, cells.map((cell) => (cell instanceof HTMLTableCellElement ? cell : element("td", {}, cell))));
const numberCell = (text) => element("td", { class: "number" }, text);
const pill = (passed, required = true) => element("span", { class: `pill ${passed ? "good" : required ? "bad" : "warn"}` }, passed ? "pass" : required ? "fail" : "over");
