// What a page does besides being read: figures tell the numbers they are pointed at, tables are copied and saved, curves are switched off,
// colours turn light or dark. Nothing is kept beyond the page, nothing is asked of a network.
'use strict';
addEventListener('DOMContentLoaded', () => {
  const svgNamespace = 'http://www.w3.org/2000/svg';

  function element(tag, properties, ...children) {
    const made = Object.assign(document.createElement(tag), properties);
    made.append(...children);
    return made;
  }

  function drawn(tag, attributes) {
    const made = document.createElementNS(svgNamespace, tag);
    for (const [name, value] of Object.entries(attributes)) made.setAttribute(name, value);
    return made;
  }

  function stored(id) {
    const found = document.getElementById(id);
    return found && JSON.parse(found.textContent);
  }

  // ---- Tables ----

  // The cells of CSV, row by row.
  function cellsOf(csv) {
    const rows = [];
    let row = [];
    for (const [, quoted, plain, end] of csv.matchAll(/(?:"((?:[^"]|"")*)"|([^,\n]*))(,|\n|$)/g)) {
      row.push(quoted === undefined ? plain : quoted.replaceAll('""', '"'));
      if (end === ',') continue;
      if (row.length > 1 || row[0] !== '') rows.push(row);
      row = [];
    }
    return rows;
  }

  const tables = new Map();

  // A table of the page by its number, read when it is first asked for.
  function tableOf(number) {
    if (!tables.has(number)) {
      const table = stored(`table-${number}`);
      const [header, ...rows] = cellsOf(table.csv);
      // Of a long table there are more rows for the figure alone.
      const whole = rows.length === table.rows;
      tables.set(number, { ...table, header, all: rows, whole, copied: whole ? rows : rows.slice(0, table.first) });
    }
    return tables.get(number);
  }

  function button(name, action) {
    return element('button', { type: 'button', textContent: name, onclick: action });
  }

  // A button that says for a while what became of it.
  function acting(name, done, action) {
    const made = button(name, async () => {
      made.textContent = (await action()) === false ? 'Not possible here' : done;
      setTimeout(() => { made.textContent = name; }, 1500);
    });
    made.setAttribute('aria-live', 'polite');
    return made;
  }

  async function copied(text) {
    try {
      await navigator.clipboard.writeText(text);
      return true;
    } catch {
      // Where a page may not reach the clipboard, a selection may.
      const area = element('textarea', { value: text });
      document.body.append(area);
      area.select();
      const done = document.execCommand('copy');
      area.remove();
      return done;
    }
  }

  const separated = rows => rows.map(row => row.map(cell => cell.replace(/\s+/g, ' ').trim()).join('\t') + '\n').join('');
  const quoted = cell => (/[",\n]/.test(cell) ? `"${cell.replaceAll('"', '""')}"` : cell);

  function saved(table) {
    const text = table.whole ? table.csv : [table.header, ...table.copied].map(row => row.map(quoted).join(',') + '\n').join('');
    const name = table.whole ? table.name : table.name.replace('.csv', `_first_${table.first}.csv`);
    const link = element('a', { href: URL.createObjectURL(new Blob([text], { type: 'text/csv' })), download: name.replaceAll('/', '_') });
    link.click();
    setTimeout(() => URL.revokeObjectURL(link.href), 1000);
  }

  function filled(table) {
    const head = element('tr', {}, ...table.header.map(name => element('th', { scope: 'col', textContent: name })));
    const rows = table.all.slice(0, table.first).map(row => element('tr', {}, ...row.map(cell => element('td', { textContent: cell }))));
    const made = element('table', { className: 'grid' }, element('thead', {}, head), element('tbody', {}, ...rows));
    const around = element('div', { className: 'rows', tabIndex: 0 }, made);
    around.setAttribute('role', 'group');
    around.setAttribute('aria-label', `Numbers of ${table.name}`);
    return around;
  }

  function details(number) {
    const table = stored(`table-${number}`);
    const size = table.rows > table.first ? `the first ${table.first} of ${table.rows} rows` : `${table.rows} row${table.rows === 1 ? '' : 's'}`;
    const tools = element('p', { className: 'tools' },
      acting('Copy', 'Copied', () => copied(separated([tableOf(number).header, ...tableOf(number).copied]))),
      acting('Save CSV', 'Saved', () => saved(tableOf(number))));
    const made = element('details', {}, element('summary', { textContent: `${table.name}, ${size}` }), tools);
    made.addEventListener('toggle', () => made.querySelector('.rows') || made.append(filled(tableOf(number))));
    return made;
  }

  for (const table of document.querySelectorAll('table[data-copy]')) {
    const rows = () => [...table.rows].map(row => [...row.cells].map(cell => cell.textContent));
    const copy = acting('Copy', 'Copied', () => copied(separated(rows())));
    copy.setAttribute('aria-label', `Copy: ${table.getAttribute('aria-label')}`);
    table.parentNode.before(element('p', { className: 'tools' }, copy));
  }

  // ---- What a figure says where it is pointed at ----

  // The box with the numbers of a figure, beside a place of it in px of the window.
  function readout(figure) {
    const box = element('div', { className: 'readout', hidden: true });
    figure.append(box);
    return {
      hide: () => { box.hidden = true; },
      show(x, y, heading, lines) {
        const rows = lines.map(({ curve, cells }) => {
          const sample = drawn('svg', { width: 18, height: 8, viewBox: '0 0 18 8', 'aria-hidden': true });
          if (curve) sample.append(drawn('path', { d: 'M0 4h18', stroke: curve.color, 'stroke-width': 2.5, ...(curve.dashes && { 'stroke-dasharray': curve.dashes }) }));
          return element('tr', {}, element('td', {}, curve ? sample : ''), ...cells.map(cell => element('td', { textContent: cell })));
        });
        box.replaceChildren(element('p', { textContent: heading }), element('table', {}, element('tbody', {}, ...rows)));
        box.hidden = false;
        const around = figure.getBoundingClientRect();
        const left = x - around.left;
        const beside = left + 14 + box.offsetWidth <= around.width ? left + 14 : left - 14 - box.offsetWidth;
        box.style.left = `${Math.max(0, Math.min(beside, around.width - box.offsetWidth))}px`;
        box.style.top = `${y - around.top}px`;
      },
    };
  }

  // Lets pointer, touch and keys move a mark over the stage of a figure: `pointed` is given a place in px of the window, `keyed` a key.
  function probe(figure, look, { pointed, keyed, left }) {
    const over = element('div', { className: 'probe', tabIndex: 0 });
    for (const [name, value] of Object.entries(look)) over.setAttribute(name, value);
    figure.querySelector('.stage').append(over);
    const move = event => pointed(event.clientX, event.clientY);
    over.addEventListener('pointermove', move);
    over.addEventListener('pointerdown', move);
    over.addEventListener('pointerleave', event => { if (event.pointerType === 'mouse' && document.activeElement !== over) left(); });
    over.addEventListener('blur', left);
    addEventListener('resize', left);
    over.addEventListener('keydown', event => {
      if (event.altKey || event.ctrlKey || event.metaKey) return;
      if (event.key === 'Escape') left();
      else if (keyed(event.key)) event.preventDefault();
    });
    return over;
  }

  // ---- Curves ----

  // The values of a curve that are defined: abscissa on the axis, ordinate, and both and the error as text.
  function samplesOf(curve, data) {
    if (curve.points) return curve.points.map(([x, y]) => ({ x: Number(x), y: Number(y), said: x, value: y }));
    const rows = tableOf(data.tables[curve.table]).all.slice(...curve.rows);
    const sample = row => {
      const x = curve.x.reduce((sum, column) => sum + Number(row[column]), 0) / curve.x.length / data.factor;
      const plain = curve.x.length === 1 && data.factor === 1;
      const error = curve.error === null ? '' : row[curve.error];
      return { x, y: Number(row[curve.y]), said: plain ? row[curve.x[0]] : String(Number(x.toPrecision(12))), value: row[curve.y], error };
    };
    return rows.filter(row => row[curve.y] !== '').map(sample);
  }

  function curvesOf(figure, data) {
    const [left, top, right, bottom] = data.frame;
    const svg = figure.querySelector('.stage svg');
    const scaled = (range, log, from, to) => {
      const at = log ? Math.log : value => value;
      return value => from + ((at(value) - at(range[0])) / (at(range[1]) - at(range[0]))) * (to - from);
    };
    const placeX = scaled(data.x, data.log[0], left, right);
    const placeY = scaled(data.y, data.log[1], bottom, top);
    const inside = x => x >= left - 0.5 && x <= right + 0.5;
    const box = readout(figure);
    const mark = svg.appendChild(drawn('g', { class: 'mark' }));
    const hidden = new Set();
    let samples = null;
    let places = [];
    let at = 0;

    // Every abscissa of the curves that are shown, once, from left to right.
    function refreshed() {
      samples ??= data.curves.map(curve => samplesOf(curve, data).map(sample => ({ ...sample, px: placeX(sample.x) })).filter(sample => inside(sample.px)));
      const shown = samples.filter((_, k) => !hidden.has(k)).flat();
      places = [...new Set(shown.map(sample => sample.px))].sort((a, b) => a - b);
      over.setAttribute('aria-valuemax', Math.max(0, places.length - 1));
    }

    function nearest(list, px, of = place => place) {
      let best = 0;
      for (let k = 1; k < list.length; k++) if (Math.abs(of(list[k]) - px) < Math.abs(of(list[best]) - px)) best = k;
      return best;
    }

    // Shows the values at one of the places; `y` in px of the window is where the box stands.
    function show(k, y) {
      at = Math.max(0, Math.min(k, places.length - 1));
      const px = places[at];
      if (px === undefined) return;
      mark.replaceChildren(drawn('path', { d: `M${px} ${top}V${bottom}` }));
      let said = '';
      const lines = [];
      samples.forEach((list, k) => {
        if (hidden.has(k) || list.length === 0) return;
        const sample = list[nearest(list, px, one => one.px)];
        const here = Math.abs(sample.px - px) < 1e-6;
        if (here) said = sample.said;
        const curve = data.curves[k];
        const value = sample.error ? `${sample.value} ± ${sample.error}` : sample.value;
        lines.push({ curve, sample, here, cells: [curve.name, value] });
        const height = placeY(sample.y);
        if (height >= top && height <= bottom) mark.append(drawn('circle', { cx: sample.px, cy: height, r: 4, fill: curve.color }));
      });
      // What stands elsewhere says where.
      for (const line of lines) if (!line.here) line.cells.push(`at ${line.sample.said}`);
      const heading = `${data.label}: ${said}`;
      over.setAttribute('aria-valuenow', at);
      over.setAttribute('aria-valuetext', [heading, ...lines.map(line => line.cells.filter(Boolean).join(' '))].join('; '));
      const frame = svg.getBoundingClientRect();
      const scale = frame.width / svg.viewBox.baseVal.width;
      box.show(frame.left + px * scale, y ?? frame.top + top * scale + 8, heading, lines);
    }

    function hide() {
      mark.replaceChildren();
      box.hide();
    }

    const keys = { ArrowLeft: () => at - 1, ArrowRight: () => at + 1, PageUp: () => at + 10, PageDown: () => at - 10, Home: () => 0, End: () => places.length - 1 };
    const name = svg.querySelector('title').textContent.split('. ')[0] || figure.id.replaceAll('_', ' ');
    const look = { role: 'slider', 'aria-label': `Values of ${name}`, 'aria-valuemin': 0, 'aria-valuemax': 0, 'aria-valuenow': 0, 'aria-valuetext': data.label };
    const over = probe(figure, look, {
      pointed(x, y) {
        if (!samples) refreshed();
        const frame = svg.getBoundingClientRect();
        show(nearest(places, (x - frame.left) * (svg.viewBox.baseVal.width / frame.width)), y + 14);
      },
      keyed(key) {
        if (!keys[key]) return false;
        if (!samples) refreshed();
        show(mark.firstChild ? keys[key]() : at);
        return true;
      },
      left: hide,
    });

    for (const entry of figure.querySelectorAll('.legend button')) {
      entry.addEventListener('click', () => {
        const curve = Number(entry.dataset.curve);
        const off = !hidden.delete(curve);
        if (off) hidden.add(curve);
        entry.setAttribute('aria-pressed', !off);
        for (const group of svg.querySelectorAll(`[data-curve="${curve}"]`)) group.classList.toggle('off', off);
        hide();
        refreshed();
      });
    }
  }

  // ---- Pictures ----

  // The values of a picture: single precision, or three digits and a power of ten.
  function unpacked(cells) {
    const bytes = Uint8Array.from(atob(cells.values), letter => letter.charCodeAt(0));
    const view = new DataView(bytes.buffer);
    if (cells.digits === 7) return Float32Array.from({ length: bytes.length / 4 }, (_, k) => view.getFloat32(4 * k, true));
    return Float64Array.from({ length: bytes.length / 2 }, (_, k) => {
      const code = view.getUint16(2 * k, true);
      if (code === 0xffff) return NaN;
      const size = code & 0x7fff;
      return size === 0 ? 0 : Number(`${code & 0x8000 ? '-' : ''}${((size - 1) % 900) + 100}e${Math.floor((size - 1) / 900) - 22}`);
    });
  }

  const short = number => String(Number(number.toPrecision(7)));

  // What a place along an axis is.
  function place(axis, k) {
    const { first, step, each, names } = axis.at;
    if (names) return `${axis.name} = ${names[k]}`;
    const low = first + step * k;
    return each > 1 ? `${axis.name} = ${low} to ${low + each - 1}` : `${axis.name} = ${short(low)}`;
  }

  function picturesOf(figure, data) {
    const stage = figure.querySelector('.stage');
    const elements = stage.querySelectorAll('img, image');
    const box = readout(figure);
    const mark = stage.appendChild(element('div', { className: 'cell', hidden: true }));
    let at = null;

    // Where a part of the picture stands, in px of the window.
    function rectangle(cells) {
      const { left, top, width, height } = elements[cells.element].getBoundingClientRect();
      const [x0, y0, x1, y1] = cells.place;
      return { left: left + x0 * width, top: top + y0 * height, width: (x1 - x0) * width, height: (y1 - y0) * height };
    }

    function show(cells, x, y) {
      const [columns, rows] = cells.axes.map(axis => axis.at.count);
      at = { cells, x: Math.max(0, Math.min(x, columns - 1)), y: Math.max(0, Math.min(y, rows - 1)) };
      cells.read ??= unpacked(cells);
      const index = at.y * columns + at.x;
      // Of a picture that is its own image about the centre the first half is kept.
      const seen = cells.read[index < cells.read.length ? index : columns * rows - 1 - index];
      const part = rectangle(cells);
      const [width, height] = [part.width / columns, part.height / rows];
      const corner = stage.getBoundingClientRect();
      const [left, top] = [part.left + at.x * width, part.top + at.y * height];
      mark.hidden = false;
      Object.assign(mark.style, { left: `${left - corner.left}px`, top: `${top - corner.top}px`, width: `${width}px`, height: `${height}px` });
      const where = `${place(cells.axes[0], at.x)}, ${place(cells.axes[1], at.y)}`;
      const said = Number.isNaN(seen) ? 'none' : String(Number(seen.toPrecision(cells.digits)));
      over.setAttribute('aria-valuetext', `${where}; ${cells.quantity} = ${said}`);
      over.setAttribute('aria-valuenow', index);
      over.setAttribute('aria-valuemax', columns * rows - 1);
      box.show(left + width, top + height + 10, where, [{ cells: [cells.quantity, said] }]);
    }

    const steps = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, -1], ArrowDown: [0, 1] };
    const name = (stage.querySelector('img')?.alt || stage.querySelector('title')?.textContent || figure.id).split('. ')[0];
    const look = { role: 'slider', 'aria-label': `Values of ${name}`, 'aria-valuemin': 0, 'aria-valuemax': 0, 'aria-valuenow': 0, 'aria-valuetext': 'not read yet' };
    const over = probe(figure, look, {
      pointed(x, y) {
        for (const cells of data.cells) {
          const { left, top, width, height } = rectangle(cells);
          const part = [(x - left) / width, (y - top) / height];
          if (part.every(p => p >= 0 && p < 1)) return show(cells, ...part.map((p, k) => Math.floor(p * cells.axes[k].at.count)));
        }
      },
      keyed(key) {
        if (!steps[key]) return false;
        const middle = data.cells[0].axes.map(axis => Math.floor(axis.at.count / 2));
        if (at === null || mark.hidden) show(at?.cells ?? data.cells[0], at?.x ?? middle[0], at?.y ?? middle[1]);
        else show(at.cells, at.x + steps[key][0], at.y + steps[key][1]);
        return true;
      },
      left() {
        mark.hidden = true;
        box.hide();
      },
    });
  }

  for (const figure of document.querySelectorAll('figure[id]')) {
    const data = stored(`data-${figure.id}`);
    if (data?.curves) curvesOf(figure, data);
    if (data?.cells?.length) picturesOf(figure, data);
    data?.tables.forEach(number => figure.append(details(number)));
  }

  // What is wider than its place can be scrolled by keys too.
  for (const wide of document.querySelectorAll('.picture, .table, pre')) {
    if (wide.scrollWidth > wide.clientWidth && !wide.querySelector('.probe')) wide.tabIndex = 0;
  }

  // ---- Light and dark ----

  const dark = () => (document.documentElement.dataset.theme ?? (matchMedia('(prefers-color-scheme: dark)').matches ? 'dark' : 'light')) === 'dark';
  const theme = button('Dark colours', () => {
    document.documentElement.dataset.theme = dark() ? 'light' : 'dark';
    theme.setAttribute('aria-pressed', dark());
  });
  theme.className = 'theme';
  theme.setAttribute('aria-pressed', dark());
  document.querySelector('header').prepend(theme);
});
