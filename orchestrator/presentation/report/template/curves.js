// What a plot draws: values of signals over time, their range, the tube of a comparison.

// Values of a signal; headings without jumps of whole turns, and beside the first heading of the plot. One that exceeds a
// turn counts turns itself: between instants that are far apart it may change by more than one.
function straightened(run, name, [firstRun, firstName]) {
  const values = run.values(name);
  if (!run.signals[name].turn) return values;
  const turns = (difference) => 2 * Math.PI * Math.round(difference / (2 * Math.PI));
  const result = Float64Array.from(values);
  if (run === firstRun && name === firstName) {
    const finite = result.filter(Number.isFinite), low = finite.reduce((a, b) => Math.min(a, b), Infinity);
    if (finite.some((value) => value - low > 2 * Math.PI + 1e-6)) return result;
    for (let i = 1; i < result.length; i++) if (Number.isFinite(result[i] + result[i - 1])) result[i] += turns(result[i - 1] - result[i]);
    return result;
  }
  const base = straightened(firstRun, firstName, [firstRun, firstName]);
  for (let i = 0; i < result.length; i++) {
    const beside = base[firstRun.row(run.time[i])];
    if (Number.isFinite(beside + result[i])) result[i] += turns(beside - result[i]);
  }
  return result;
}

// A y range with some air, never narrower than `least`, and never empty.
function widened(low, high, least) {
  if (low === null || high === null) return [-1, 1];
  const span = Math.max(high - low, least, 1e-9 * Math.max(Math.abs(low), Math.abs(high)), 1e-6), middle = (low + high) / 2;
  return [middle - 0.56 * span, middle + 0.56 * span];
}

// The tube a comparison judged by: highest and lowest value of `run` within the time tolerance, widened by that in value.
function tube(run, values, rule, t) {
  const { absolute, relative, time_tolerance: reach } = rule, from = run.row(t - reach), to = run.row(t + reach);
  let low = Infinity, high = -Infinity;
  const take = (value) => {
    if (!Number.isFinite(value)) return;
    const room = Math.max(absolute, relative * Math.abs(value));
    low = Math.min(low, value - room); high = Math.max(high, value + room);
  };
  const between = (at) => {
    const row = run.row(at), step = run.time[row + 1] - run.time[row], share = Math.min(1, Math.max(0, (at - run.time[row]) / step));
    return step > 0 ? values[row] + share * (values[row + 1] - values[row]) : values[row];
  };
  take(between(t - reach)); take(between(t + reach)); take(between(t));
  for (let row = from + 1; row <= to; row++) take(values[row]);
  return [low, high];
}
