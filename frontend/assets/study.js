/* The table of a study: a run's number leads to it, numbers have four figures. */
(function () {
  "use strict";
  const functions = (window.dashAgGridFunctions = window.dashAgGridFunctions || {});
  const cells = (window.dashAgGridComponentFunctions = window.dashAgGridComponentFunctions || {});

  functions.studyNumber = (params) =>
    typeof params.value === "number" ? Number(params.value.toPrecision(4)).toString() : params.value;

  cells.StudyRun = function (props) {
    const place = window.location.pathname.replace(/\/studies\/.*$/, `/runs/${props.data.run_id}`);
    return window.React.createElement("a", { href: place }, `run ${props.value}`);
  };
})();
