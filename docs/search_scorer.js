// Scores of the search. Pages for developers and records of changes come after all others.
var Scorer = {
  score: ([docname, , , , score]) =>
    /^(map|contributing|growth|renamed|changelog|decisions\/|validation\/)/.test(docname) ? score - 1000 : score,
  objNameMatch: 11,
  objPartialMatch: 6,
  objPrio: { 0: 15, 1: 5, 2: -5 },
  objPrioDefault: 0,
  title: 15,
  partialTitle: 7,
  term: 5,
  partialTerm: 2,
};
