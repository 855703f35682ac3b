// Tables of a page: each is copied to the clipboard, or saved as a CSV file, as it stands.

/** Signs that are set for reading, as programs write them: true minus, powers of ten. */
function plain(text: string): string {
  const digits = "⁰¹²³⁴⁵⁶⁷⁸⁹";
  const power = /·10([⁻⁰¹²³⁴⁵⁶⁷⁸⁹]+)/g;
  const exponents = text.replace(power, (_, found: string) => `e${[...found].map((sign) => (sign === "⁻" ? "-" : String(digits.indexOf(sign)))).join("")}`);
  return exponents.replace(/−(?=\d|inf)/g, "-").trim();
}

/** A head with its unit in brackets, or what a cell says. */
function text(cell: HTMLTableCellElement): string {
  const unit = cell.querySelector(".unit")?.textContent ?? "";
  const whole = plain(cell.textContent ?? "");
  return unit ? `${whole.slice(0, -plain(unit).length).trim()} [${plain(unit)}]` : whole;
}

function rows(table: HTMLTableElement): string[][] {
  return [...table.rows].map((row) => [...row.cells].map(text));
}

/** Lines as RFC 4180 has them. */
function csv(lines: string[][]): string {
  const field = (cell: string): string => (/[",\r\n]/.test(cell) ? `"${cell.replaceAll('"', '""')}"` : cell);
  return lines.map((line) => line.map(field).join(",") + "\r\n").join("");
}

function tsv(lines: string[][]): string {
  return lines.map((line) => line.map((cell) => cell.replace(/\s+/g, " ")).join("\t")).join("\n") + "\n";
}

async function copy(content: string): Promise<boolean> {
  try {
    await navigator.clipboard.writeText(content);
    return true;
  } catch {
    return copyBySelection(content); // pages from a file may not be trusted with the clipboard
  }
}

function copyBySelection(content: string): boolean {
  const area = document.createElement("textarea");
  area.value = content;
  area.style.cssText = "position:fixed;top:0;opacity:0";
  document.body.append(area);
  area.select();
  const done = document.execCommand("copy");
  area.remove();
  return done;
}

function save(content: string, name: string): void {
  const link = document.createElement("a");
  link.href = URL.createObjectURL(new Blob(["\ufeff", content], { type: "text/csv;charset=utf-8" })); // with a byte order mark for spreadsheets
  link.download = name;
  link.click();
  setTimeout(() => URL.revokeObjectURL(link.href), 10_000);
}

/** The file name of a table: the page's title and the table's own, else its section's. */
function fileName(table: HTMLTableElement): string {
  const own = table.caption?.textContent ?? table.closest("section")?.querySelector("h2")?.textContent ?? "table";
  const stage = document.querySelector("h1")?.textContent ?? "";
  return `${[stage, own].join(" ").toLowerCase().replace(/[^\p{L}\p{N}.]+/gu, "-").replace(/^-|-$/g, "").slice(0, 80)}.csv`;
}

function button(word: string, about: string, act: (pressed: HTMLButtonElement) => void): HTMLButtonElement {
  const made = document.createElement("button");
  made.type = "button";
  made.textContent = word;
  made.title = about;
  made.addEventListener("click", () => act(made));
  return made;
}

/** Says something in place of a button's word for a moment. */
function say(pressed: HTMLButtonElement, words: string): void {
  const before = pressed.textContent;
  pressed.textContent = words;
  setTimeout(() => (pressed.textContent = before), 1500);
}

/** Puts the buttons under every table. */
export function addTools(): void {
  for (const frame of document.querySelectorAll<HTMLElement>("div.table")) {
    const table = frame.querySelector("table");
    if (!table) continue;
    const tools = document.createElement("p");
    tools.className = "tools";
    tools.append(
      button("Copy", "Copy the table, for a spreadsheet", async (pressed) => say(pressed, (await copy(tsv(rows(table)))) ? "Copied" : "Not copied")),
      button("CSV", "Save the table as a CSV file", () => save(csv(rows(table)), fileName(table))),
    );
    frame.after(tools);
  }
}

/** What is wider than its place fades where more of it is: a number that is cut would be read as another one. */
export function fadeEdges(): void {
  for (const frame of document.querySelectorAll<HTMLElement>("div.table")) {
    const mark = (): void => void frame.classList.toggle("more", frame.scrollWidth - frame.clientWidth - frame.scrollLeft > 2);
    frame.addEventListener("scroll", mark, { passive: true });
    new ResizeObserver(mark).observe(frame);
  }
}
