// Ranks what teaches before what lists: tutorials first, generated keys and modules last.
"use strict";

const WEIGHTS = [
  ["tutorials/", 4],
  ["how_to/", 3],
  ["studies/", 2],
  ["machines/", 2],
  ["theory/", 1.5],
  ["reference/case_file/", 0.1],
  ["reference/results", 0.3],
  ["api/", 0.05],
  ["developer/", 0.5],
];

// eslint-disable-next-line no-unused-vars
var Scorer = {
  score: ([docName, title, anchor, description, score]) => {
    const found = WEIGHTS.find(([folder]) => docName.startsWith(folder));
    return score * (found === undefined ? 1 : found[1]);
  },
  objNameMatch: 11,
  objPartialMatch: 6,
  objPrio: { 0: 15, 1: 5, 2: -5 },
  objPrioDefault: 0,
  title: 15,
  partialTitle: 7,
  term: 5,
  partialTerm: 2,
};
