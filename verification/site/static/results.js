// Tables that sort, the register with its filters, folded parts that a link or a printer opens.
for (const table of document.querySelectorAll("table.sortable")) {
  for (const [k, head] of [...table.tHead.rows[0].cells].entries()) head.addEventListener("click", () => sort(table, k, head));
}
// By a column, a second time in the other direction.
function sort(table, k, head) {
  const down = head.dataset.sorted === "up", rows = [...table.tBodies[0].rows];
  for (const other of table.tHead.rows[0].cells) delete other.dataset.sorted;
  head.dataset.sorted = down ? "down" : "up";
  const raised = "⁻⁰¹²³⁴⁵⁶⁷⁸⁹", digits = "-0123456789";
  const value = row => {
    const text = row.cells[k].textContent.trim(), power = text.match(/^(?:(-?[\d.]+)·)?10([⁻⁰¹²³⁴⁵⁶⁷⁸⁹]+)/);
    return power ? (power[1] ?? 1) * 10 ** [...power[2]].map(c => digits[raised.indexOf(c)]).join("") : parseFloat(text);
  };
  rows.sort((a, b) => {
    const [x, y] = [value(a), value(b)];
    return isNaN(x) || isNaN(y) ? a.cells[k].textContent.localeCompare(b.cells[k].textContent) : x - y;
  });
  if (down) rows.reverse();
  table.tBodies[0].append(...rows);
}

for (const register of document.querySelectorAll(".register")) {
  const words = register.querySelector("input"), selects = [...register.querySelectorAll("select")];
  const rows = [...register.querySelectorAll("tbody tr")].map(row => [row, `${row.textContent} ${row.dataset.words}`.toLowerCase()]);
  const show = () => {
    const wanted = words.value.toLowerCase().split(/\s+/).filter(Boolean);
    let count = 0;
    for (const [row, text] of rows) {
      row.hidden = !wanted.every(word => text.includes(word)) || selects.some(one => one.value && row.dataset[one.name] !== one.value);
      count += !row.hidden;
    }
    register.querySelector("output").textContent = `${count} of ${rows.length}`;
  };
  register.addEventListener("input", show);
  show();
}

function open_linked() {
  const linked = document.getElementById(decodeURIComponent(location.hash.slice(1))), folded = linked?.closest("details");
  if (folded) { folded.open = true; linked.scrollIntoView(); }
}
addEventListener("hashchange", open_linked);
open_linked();

// On paper nothing is folded.
let folded = [];
addEventListener("beforeprint", () => {
  folded = [...document.querySelectorAll("article details:not([open])")];
  for (const element of folded) element.open = true;
});
addEventListener("afterprint", () => { for (const element of folded) element.open = false; });
