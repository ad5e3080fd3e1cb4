"use strict";
/* The page of a study: draws figures when they come into view, fills tables and scenarios when they are opened.
   Whatever comes from the data is set as text, never as HTML. */
(() => {
  const locale = navigator.languages && navigator.languages.length ? [...navigator.languages] : undefined;
  const parts = new Intl.NumberFormat(locale).formatToParts(-12345678.9);
  const part = (type, otherwise) => (parts.find((one) => one.type === type) || { value: otherwise }).value;
  const FORMAT = { decimal: part("decimal", "."), thousands: part("group", "\u202f"), grouping: [3], currency: ["", ""], minus: "\u2212" };
  const whole = new Intl.NumberFormat(locale);
  const plain = new Intl.NumberFormat(locale, { maximumSignificantDigits: 6 });
  const precise = new Intl.NumberFormat(locale, { maximumSignificantDigits: 8 });
  const power = new Intl.NumberFormat(locale, { maximumSignificantDigits: 4, notation: "scientific" });
  const { palette: PALETTE, dashes: DASHES } = JSON.parse(document.getElementById("styles").textContent);
  // A chart of more marks is drawn on a canvas.
  const MOST_SHAPES = 6000;
  const FEW_CHOICES = 12;
  const MOST_COLUMNS = 8;

  // ---- small helpers ----

  const make = (name, attributes = {}, ...children) => {
    const element = document.createElement(name);
    for (const [key, value] of Object.entries(attributes)) {
      if (key === "class") element.className = value;
      else if (key.startsWith("on")) element.addEventListener(key.slice(2), value);
      else element.setAttribute(key, value);
    }
    element.append(...children);
    return element;
  };
  const words = (name) => String(name).replaceAll("_", " ");
  const written = (value, format = plain) => {
    if (value === null || value === undefined || Number.isNaN(value)) return "–";
    if (typeof value !== "number") return String(value);
    const size = Math.abs(value);
    return size !== 0 && (size < 1e-4 || size >= 1e9) ? power.format(value) : format.format(value);
  };
  const unpacked = new Map();
  const unpack = (scene) => {
    if (!unpacked.has(scene)) {
      unpacked.set(scene, (async () => {
        const bytes = Uint8Array.from(atob(document.getElementById(`packed-${scene}`).textContent), (c) => c.charCodeAt(0));
        const stream = new Blob([bytes]).stream().pipeThrough(new DecompressionStream("gzip"));
        return JSON.parse(await new Response(stream).text());
      })());
    }
    return unpacked.get(scene);
  };
  const save = (name, content, type) => {
    const link = make("a", { href: URL.createObjectURL(new Blob([content], { type })), download: name });
    link.click();
    setTimeout(() => URL.revokeObjectURL(link.href), 10000);
  };
  const csv = (rows) => rows.map((row) => row.map((cell) => {
    const text = cell === null || cell === undefined ? "" : String(cell);
    return /[",\n\r]/.test(text) ? `"${text.replaceAll('"', '""')}"` : text;
  }).join(",")).join("\n") + "\n";
  const trouble = (place, problem) => {
    place.append(make("p", { class: "hint", role: "alert" }, `This part cannot be shown: ${problem.message}`));
    console.error(problem);
  };

  // ---- what the pointer is on ----

  const tip = make("div", { class: "tip", hidden: "" });
  document.body.append(tip);
  const tell = (_, event, item, value) => {
    if (value === null || value === undefined || value === "") { tip.hidden = true; return; }
    const list = make("dl");
    const lines = typeof value === "object" ? Object.entries(value) : [["", value]];
    for (const [name, text] of lines) list.append(make("dt", {}, name.trim()), make("dd", {}, String(text)));
    tip.replaceChildren(list);
    tip.hidden = false;
    const box = tip.getBoundingClientRect();
    tip.style.left = `${Math.max(4, Math.min(event.clientX + 12, innerWidth - box.width - 4))}px`;
    tip.style.top = `${Math.max(4, event.clientY + 16 + box.height > innerHeight ? event.clientY - box.height - 10 : event.clientY + 16)}px`;
  };
  addEventListener("scroll", () => { tip.hidden = true; }, { passive: true });

  // ---- figures ----

  const rowsOf = (columns) => {
    if (!columns.along) {
      const names = Object.keys(columns);
      return (columns[names[0]] || []).map((_, i) => Object.fromEntries(names.map((name) => [name, columns[name][i]])));
    }
    const along = rowsOf(columns.along);
    const up = Object.keys(columns.up).length ? rowsOf(columns.up) : [{}];
    return up.flatMap((below, j) => along.map((beside, i) => {
      const row = { ...beside, ...below };
      for (const name of Object.keys(columns.cells)) row[name] = columns.cells[name][j * along.length + i];
      if (Number.isInteger(beside.scenario)) row.scenario = beside.scenario + (below.scenario || 0);
      return row;
    }));
  };
  const look = (width) => ({
    background: "#ffffff",
    font: "system-ui, sans-serif",
    view: { stroke: "#bbbbbb" },
    axis: { gridColor: "#e3e3e3", labelFontSize: 11, titleFontSize: 12, titleFontWeight: 500, labelOverlap: "greedy", labelSeparation: 5, titleLimit: width - 40 },
    axisY: { titleLimit: 300 },
    legend: {
      orient: "bottom", labelFontSize: 11, titleFontSize: 11, titleFontWeight: 500, labelLimit: width - 70, titleLimit: width - 40,
      columns: Math.max(1, Math.floor(width / 230)), symbolSize: 140, symbolStrokeWidth: 2.2, gradientLength: Math.min(240, width - 80),
      layout: { bottom: { direction: "vertical", anchor: "middle", margin: 4 } },
    },
  });
  const draw = async (place, panel, description, height) => {
    const width = Math.floor(place.clientWidth);
    const datasets = Object.fromEntries(Object.entries(panel.data).map(([name, columns]) => [name, rowsOf(columns)]));
    const count = Object.values(datasets).reduce((sum, rows) => sum + rows.length, 0);
    const spec = {
      ...panel.spec, datasets, width, height,
      autosize: { type: "fit-x", contains: "padding" }, padding: 4, description, config: look(width),
    };
    const { view } = await vegaEmbed(place, spec, {
      mode: "vega-lite", ast: true, actions: false, defaultStyle: false, tooltip: tell, formatLocale: FORMAT,
      renderer: count > MOST_SHAPES ? "canvas" : "svg", loader: { http: { credentials: "omit" } },
    });
    return view;
  };
  // Room for the axis beside an area whose scales are equal, and how low and high it may be.
  const BESIDE = 66, LOWEST = 70, HIGHEST = 540;
  const heightOf = (panel, width) => panel.aspect === null
    ? panel.height
    : Math.round(Math.max(LOWEST, Math.min(HIGHEST, (width - BESIDE) * panel.aspect)));
  const drawn = new Map();
  const drawFigure = (figure) => {
    if (!drawn.has(figure)) drawn.set(figure, drawPanels(figure));
    return drawn.get(figure);
  };
  const drawPanels = async (figure) => {
    const scene = figure.closest("article").dataset.scene;
    const place = figure.querySelector(".panels");
    try {
      const found = (await unpack(scene)).figures[Number(figure.dataset.figure)];
      place.classList.toggle("many", found.panels.length > 1);
      figure.views = [];
      for (const panel of found.panels) {
        const chart = make("div", { class: "chart" });
        const box = make("div", { class: "panel" }, chart);
        if (panel.title) box.prepend(make("h3", {}, panel.title));
        place.append(box);
        const description = [figure.getAttribute("aria-label"), panel.title].filter(Boolean).join(": ");
        const view = await draw(chart, panel, description, heightOf(panel, chart.clientWidth));
        view.addEventListener("click", (_, item) => {
          const number = item && item.datum && item.datum.scenario;
          if (Number.isInteger(number)) showScenario(figure.closest("article"), number, figure);
        });
        figure.views.push(view);
      }
      figure.append(figureTools(figure, found, scene));
      figure.dataset.drawn = "yes";
    } catch (problem) {
      trouble(figure, problem);
    }
  };
  const figureTools = (figure, found, scene) => {
    const name = (i, ending) => `${scene}_${found.name}${figure.views.length > 1 ? `_${i + 1}` : ""}.${ending}`;
    const image = (kind) => async () => {
      for (const [i, view] of figure.views.entries()) {
        if (kind === "svg") save(name(i, "svg"), await view.toSVG(), "image/svg+xml");
        else (await view.toCanvas(2)).toBlob((blob) => save(name(i, "png"), blob, "image/png"));
      }
    };
    const numbers = () => found.panels.forEach((panel, i) => {
      const rows = rowsOf(panel.data.rows || Object.values(panel.data)[0]);
      const names = Object.keys(rows[0] || {});
      save(name(i, "csv"), csv([names, ...rows.map((row) => names.map((key) => row[key]))]), "text/csv");
    });
    return make("div", { class: "tools" },
      make("button", { type: "button", onclick: image("svg") }, "SVG"),
      make("button", { type: "button", onclick: image("png") }, "PNG"),
      make("button", { type: "button", onclick: numbers }, "Data (CSV)"));
  };

  // ---- tables ----

  const NUMBER = /^[-+]?(\d+\.?\d*|\.\d+)(e[-+]?\d+)?$/i;
  const shortened = (text) => text.length > 9 && NUMBER.test(text) ? written(Number(text)) : text;
  const cellText = (text, asPrinted) => {
    if (asPrinted || !NUMBER.test(text)) return text;
    return text.length <= 9 && !/e/i.test(text) ? text.replace(".", FORMAT.decimal) : shortened(text);
  };
  // Told apart by a sign, not by colour alone; any other verdict is that a cell is off.
  const VERDICTS = new Map([["agrees", ["verdict-good", "✓"]], ["rounded key", ["", "≈"]]]);
  const fillTable = async (details) => {
    if (details.dataset.filled) return;
    details.dataset.filled = "yes";
    const scene = details.closest("article").dataset.scene;
    const table = (await unpack(scene)).tables[Number(details.dataset.table)];
    const numeric = table.head.map((_, i) => table.rows.every((row) => row[i] === "" || NUMBER.test(row[i])));
    const body = make("tbody");
    const show = (rows) => body.replaceChildren(...rows.map((row) => make("tr", {}, ...row.map((text, i) => {
      const cell = make("td", numeric[i] ? { class: "number" } : {}, cellText(text, table.head[i] === "printed"));
      if (numeric[i] && text.length > 9) cell.title = text;
      if (table.head[i] === "flag") {
        const [kind, mark] = VERDICTS.get(text) || ["verdict-bad", "✗"];
        cell.className = kind;
        cell.textContent = `${mark} ${text}`;
      }
      return cell;
    }))));
    const heads = table.head.map((name, i) => {
      const head = make("th", { scope: "col", "aria-sort": "none", ...(numeric[i] ? { class: "number" } : {}) });
      head.append(make("button", { type: "button", title: "Sort by this column", onclick: () => {
        const next = { none: "ascending", ascending: "descending", descending: "none" }[head.getAttribute("aria-sort")];
        heads.forEach((other) => other.setAttribute("aria-sort", "none"));
        head.setAttribute("aria-sort", next);
        show(sorted(table.rows, i, numeric[i], next));
      } }, name));
      return head;
    });
    show(table.rows);
    const note = table.rows.length < table.count
      ? `The first ${whole.format(table.rows.length)} of ${whole.format(table.count)} rows; all are in tables/${table.file} beside this page.`
      : "";
    details.append(
      make("div", { class: "tools" },
        make("button", { type: "button", onclick: () => save(table.file, csv([table.head, ...table.rows]), "text/csv") }, "CSV"),
        make("span", { class: "hint" }, note)),
      make("div", { class: "wide" }, make("table", {}, make("thead", {}, make("tr", {}, ...heads)), body)));
  };
  const sorted = (rows, i, numeric, direction) => {
    if (direction === "none") return rows;
    const sign = direction === "ascending" ? 1 : -1;
    const empty = (text) => text === "" || text === "-";
    return [...rows].sort((a, b) => {
      if (empty(a[i]) || empty(b[i])) return empty(a[i]) - empty(b[i]);
      return sign * (numeric ? Number(a[i]) - Number(b[i]) : a[i].localeCompare(b[i], locale, { numeric: true }));
    });
  };

  // ---- scenarios ----

  const places = (axes, number) => {
    const found = [];
    for (const axis of [...axes].reverse()) {
      found.unshift(number % axis.size);
      number = Math.floor(number / axis.size);
    }
    return found;
  };
  const numberOf = (axes, at) => axes.reduce((sum, axis, i) => sum * axis.size + at[i], 0);
  const given = (scenarios, at) => {
    const values = { ...scenarios.fixed };
    scenarios.axes.forEach((axis, i) => {
      for (const [name, column] of Object.entries(axis.parameters)) values[name] = column[at[i]];
    });
    return values;
  };
  const command = (scenarios, method, values) => {
    const told = method.parameters.map(([name, columns]) => {
      const known = columns.map((column) => values[column]).filter((value) => value !== null && value !== undefined);
      return known.length ? `${name}=${known.join(",")}` : "";
    });
    return ["cablesim solve", method.solver, ...told, method.options].filter(Boolean).join(" ");
  };
  const inUnits = (value, unit) => {
    if (typeof value !== "number") return written(value);
    if (unit === "rad") return `${written((value * 180) / Math.PI)}°`;
    return !unit ? written(value) : `${written(value)} ${unit}`;
  };
  const pointText = (scenarios, axis, i) => {
    const columns = Object.entries(axis.parameters);
    if (columns.length > 3) return `${i + 1}`;
    return columns.map(([name, values]) => `${columns.length > 1 ? `${words(name)} ` : ""}${inUnits(values[i], scenarios.units[name])}`).join(", ");
  };
  const cards = new Map();
  const showScenario = async (article, number, after) => {
    const details = article.querySelector("details.scenario");
    if (after) after.after(details);
    details.open = true;
    const card = await cardOf(details);
    if (card) await card.show(number);
    if (after && details.getBoundingClientRect().top > innerHeight - 120) details.scrollIntoView({ block: "nearest" });
  };
  const cardOf = (details) => {
    if (!cards.has(details)) cards.set(details, makeCard(details).catch((problem) => trouble(details, problem)));
    return cards.get(details);
  };
  const makeCard = async (details) => {
    const scene = details.closest("article").dataset.scene;
    const { scenarios } = await unpack(scene);
    if (!scenarios.axes) {
      details.append(make("p", { class: "hint" }, `${scenarios.left_out[0]}: ask for them with cablesim query.`));
      return null;
    }
    const total = scenarios.axes.reduce((product, axis) => product * axis.size, 1);
    const heading = make("p", { "aria-live": "polite" });
    const body = make("div", { class: "result" });
    let at = scenarios.axes.map(() => 0);
    const controls = scenarios.axes.map((axis, i) => control(scenarios, axis, (value) => { at[i] = value; refresh(); }));
    const refresh = () => {
      controls.forEach((one, i) => one.set(at[i]));
      const number = numberOf(scenarios.axes, at);
      heading.textContent = `Scenario ${whole.format(number + 1)} of ${whole.format(total)}`;
      details.dataset.number = number;
      body.replaceChildren(...result(scenarios, number, at));
      return drawLines(body, scenarios, number);
    };
    details.append(heading, make("div", { class: "controls" }, ...controls.map((one) => one.element)), body);
    const card = { show: (number) => { at = places(scenarios.axes, number); return refresh(); } };
    await card.show(0);
    return card;
  };
  const control = (scenarios, axis, changed) => {
    const text = (i) => pointText(scenarios, axis, i);
    const name = words(axis.name);
    if (axis.size <= FEW_CHOICES) {
      const choices = Array.from({ length: axis.size }, (_, i) => make("option", { value: i }, text(i)));
      const select = make("select", { onchange: () => changed(Number(select.value)) }, ...choices);
      return { element: make("label", {}, name, select), set: (i) => { select.value = i; } };
    }
    const output = make("output");
    const slider = make("input", { type: "range", min: 0, max: axis.size - 1, step: 1, oninput: () => changed(Number(slider.value)) });
    const set = (i) => {
      slider.value = i;
      output.textContent = text(i);
      slider.setAttribute("aria-valuetext", text(i));
    };
    return { element: make("label", {}, `${name}: `, output, slider), set };
  };
  const result = (scenarios, number, at) => {
    const values = given(scenarios, at);
    const parameters = make("tbody", {}, ...Object.entries(values).filter(([, value]) => value !== null).map(([name, value]) =>
      make("tr", {}, make("td", {}, words(name)), make("td", { class: "number" }, inUnits(value, scenarios.units[name])))));
    const blocks = [make("div", { class: "wide" }, make("table", {}, make("caption", {}, "Given"), parameters))];
    const methods = scenarios.methods.slice(0, MOST_COLUMNS);
    if (scenarios.outputs.length) blocks.push(answers(scenarios, methods, number));
    const notes = [...scenarios.left_out];
    if (scenarios.methods.length > methods.length) notes.push(`of ${scenarios.methods.length} methods the first ${methods.length} are shown`);
    const shown = make("code", {}, command(scenarios, scenarios.methods[0], values));
    const choose = make("select", { "aria-label": "method", onchange: () => { shown.textContent = command(scenarios, scenarios.methods[Number(choose.value)], values); } },
      ...scenarios.methods.map((method, i) => make("option", { value: i }, words(method.name))));
    const copy = make("button", { type: "button", onclick: async () => {
      try {
        await navigator.clipboard.writeText(shown.textContent);
        copy.textContent = "Copied";
      } catch {
        getSelection().selectAllChildren(shown);
      }
    } }, "Copy");
    return [
      make("div", { class: "views" }, ...blocks, make("div", { class: "profile", hidden: "" }), make("div", { class: "history", hidden: "" })),
      make("div", { class: "tools" }, make("span", {}, "The command that solves it again, by "), choose, copy),
      make("pre", { class: "command" }, shown),
      ...(notes.length ? [make("p", { class: "hint" }, `Not in this page: ${notes.join("; ")}.`)] : []),
    ];
  };
  const answers = (scenarios, methods, number) => {
    const head = make("tr", {}, make("th", { scope: "col" }, "Found"), ...methods.map((method) => make("th", { scope: "col", class: "number" }, words(method.name))));
    const fate = (i) => scenarios.fates.values[i][number];
    const status = make("tr", {}, make("td", {}, "status"), ...methods.map((_, i) =>
      make("td", { class: "number", title: scenarios.fates.sentences[fate(i)] }, scenarios.fates.words[fate(i)])));
    const rows = scenarios.outputs.map((output) => make("tr", {},
      make("td", { title: output.meaning }, words(output.name) + (output.unit ? ` [${output.unit}]` : "")),
      ...methods.map((_, i) => {
        const value = output.values[i][number];
        return make("td", { class: "number" }, output.words ? words(output.words[value] ?? "–") : written(value, precise));
      })));
    const shape = methods.length > 2 ? "wide whole" : "wide";
    return make("div", { class: shape }, make("table", {}, make("thead", {}, head), make("tbody", {}, status, ...rows)));
  };
  // Values that are held as whole numbers between their lowest and highest.
  const curve = (held, line) => {
    const scale = (held.highest[line] - held.lowest[line]) / held.steps;
    return held.values.slice(line * held.length, (line + 1) * held.length).map((step) => step < 0 ? null : held.lowest[line] + step * scale);
  };
  const drawLines = async (body, scenarios, number) => {
    const total = scenarios.axes.reduce((product, axis) => product * axis.size, 1);
    const methods = scenarios.methods.slice(0, MOST_COLUMNS);
    if (scenarios.profiles) {
      const held = scenarios.profiles;
      const ways = held.components.length;
      const rows = methods.flatMap((method, m) => {
        const [x, ...others] = held.components.map((_, c) => curve(held, (m * total + number) * ways + c));
        const z = others[others.length - 1];
        return x.map((value, node) => ({ x: value, y: z[node], node, series: words(method.name) })).filter((row) => row.x !== null && row.y !== null);
      });
      const from = (name) => rows.map((row) => row[name]);
      const span = (list) => Math.max(...list) - Math.min(...list);
      const aspect = rows.length && span(from("x")) > 0 ? span(from("y")) / span(from("x")) : 1;
      await small(body.querySelector(".profile"), rows, "The line", "x [m]", "z [m]", methods, Math.max(0.25, Math.min(1.1, aspect)));
    }
    if (scenarios.histories) {
      const held = scenarios.histories;
      const rows = methods.flatMap((method, m) => held.places.flatMap((place, p) => {
        const first = held.first[m * total + number], last = held.last[m * total + number];
        return curve(held, (m * total + number) * held.places.length + p).map((value, i) => ({
          x: first + ((last - first) * i) / Math.max(1, held.length - 1), y: value / 1000, node: i,
          series: methods.length > 1 ? `${words(method.name)}, ${place}` : place,
        })).filter((row) => Number.isFinite(row.x) && Number.isFinite(row.y));
      }));
      await small(body.querySelector(".history"), rows, "The end of its history", "time [s]", "tension [kN]", methods, 0.5);
    }
  };
  const small = async (place, rows, title, x, y, methods, aspect) => {
    if (!place) return;
    place.hidden = !rows.length;
    if (!rows.length) return;
    const chart = make("div", { class: "chart" });
    place.replaceChildren(make("h3", {}, title), chart);
    const names = [...new Set(rows.map((row) => row.series))];
    const legend = names.length > 1 ? { title: null, symbolType: "stroke" } : null;
    const axis = (field, name) => ({ field, type: "quantitative", title: name, scale: { zero: false } });
    const spec = {
      data: { name: "rows" }, mark: { type: "line", tooltip: true, strokeWidth: 1.6 },
      encoding: {
        x: axis("x", x), y: axis("y", y), order: { field: "node", type: "quantitative" },
        color: { field: "series", type: "nominal", sort: null, scale: { domain: names, range: names.map((_, i) => PALETTE[i % PALETTE.length]) }, legend },
        strokeDash: { field: "series", type: "nominal", sort: null, scale: { domain: names, range: names.map((_, i) => DASHES[i % DASHES.length]) }, legend },
        tooltip: [{ field: "series", type: "nominal", title: " " }, { field: "x", type: "quantitative", title: x, format: ".4~g" }, { field: "y", type: "quantitative", title: y, format: ".4~g" }],
      },
    };
    const data = { rows: Object.fromEntries(["x", "y", "node", "series"].map((key) => [key, rows.map((row) => row[key])])) };
    const height = heightOf({ aspect }, chart.clientWidth);
    await draw(chart, { spec, data }, title, Math.min(320, height));
  };

  // ---- the page as a whole ----

  const watcher = new IntersectionObserver((entries) => {
    for (const entry of entries) {
      if (!entry.isIntersecting) continue;
      watcher.unobserve(entry.target);
      drawFigure(entry.target);
    }
  }, { rootMargin: "500px" });
  const localise = () => {
    for (const element of document.querySelectorAll("[data-number]")) element.textContent = whole.format(Number(element.textContent));
    for (const element of document.querySelectorAll("[data-seconds]")) element.textContent = written(Number(element.textContent));
    if (FORMAT.decimal === ".") return;
    for (const element of document.querySelectorAll("[data-prose]")) element.textContent = element.textContent.replace(/(\d)\.(?=\d)/g, `$1${FORMAT.decimal}`);
  };
  const drawAll = () => [...document.querySelectorAll("figure")].reduce((before, figure) => before.then(() => drawFigure(figure)), Promise.resolve());
  const filter = document.getElementById("filter");
  filter.addEventListener("input", () => {
    const wanted = filter.value.toLocaleLowerCase(locale).split(/\s+/).filter(Boolean);
    for (const row of document.querySelectorAll(".index tbody tr")) {
      const article = document.getElementById(row.querySelector("a").getAttribute("href").slice(1));
      const text = `${row.textContent} ${article.id} ${article.querySelector(".question")?.textContent ?? ""}`.toLocaleLowerCase(locale);
      row.hidden = !wanted.every((one) => text.includes(one));
    }
  });
  const printing = document.getElementById("print");
  printing.addEventListener("click", async () => {
    printing.disabled = true;
    await drawAll();
    for (const details of document.querySelectorAll("details[data-table]")) {
      await fillTable(details);
      details.open = details.querySelectorAll("tbody tr").length <= 60;
    }
    printing.disabled = false;
    print();
  });
  for (const details of document.querySelectorAll("details[data-table]")) {
    details.addEventListener("toggle", () => { if (details.open) fillTable(details).catch((problem) => trouble(details, problem)); });
  }
  for (const details of document.querySelectorAll("details.scenario")) {
    details.addEventListener("toggle", () => { if (details.open) cardOf(details); });
  }
  localise();
  document.querySelectorAll("figure").forEach((figure) => watcher.observe(figure));
  // For whoever drives the page by a program.
  const scenarioOf = async (scene, number, method) => {
    const { scenarios } = await unpack(scene);
    const outputs = scenarios.outputs.map((output) => [output.name, output.values[method][number]]);
    return {
      command: command(scenarios, scenarios.methods[method], given(scenarios, places(scenarios.axes, number))),
      status: scenarios.fates ? scenarios.fates.words[scenarios.fates.values[method][number]] : null,
      outputs: Object.fromEntries(outputs),
    };
  };
  window.cablesim = { drawAll, drawFigure, scenarioOf, unpack };
})();
