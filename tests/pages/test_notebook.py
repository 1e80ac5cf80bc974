"""Results show themselves in a Jupyter notebook: text, tables and pictures, in a real kernel."""

import pytest

pytestmark = pytest.mark.long

CELLS = (
    "import vehicledyn as vd",
    'motion = vd.simulate("quarter_car", duration="0.5 s")',
    "motion",
    'motion["body.height"]',
    'motion.plot("body.height", "wheel.height")',
    'vd.load("quarter_car")',
)


@pytest.fixture(scope="module")
def outputs(tmp_path_factory):
    """What each cell shows, by media type."""
    reason = "notebooks need nbclient and ipykernel; install them to run this test"
    nbclient = pytest.importorskip("nbclient", reason=reason)
    pytest.importorskip("ipykernel", reason=reason)
    nbformat = pytest.importorskip("nbformat", reason=reason)
    cells = [nbformat.v4.new_code_cell(text) for text in CELLS]
    book = nbformat.v4.new_notebook(cells=cells)
    place = {"metadata": {"path": str(tmp_path_factory.mktemp("notebook"))}}
    nbclient.NotebookClient(book, timeout=300, kernel_name="python3", resources=place).execute()
    return [[dict(item.get("data", {})) for item in cell.outputs] for cell in book.cells]


@pytest.mark.filterwarnings("ignore")
def test_results_arrays_and_figures_show_themselves(outputs):
    run, array, figure, scenario = (cell[-1] for cell in outputs[2:])
    assert "<table>" in run["text/html"] and "body.height" in run["text/html"]
    assert "time: " in array["text/html"] and "[m]" in array["text/html"]
    assert len(figure["image/png"]) > 10_000
    assert "quarter car" in scenario["text/plain"]


@pytest.mark.filterwarnings("ignore")
def test_simulating_shows_nothing(outputs):
    assert outputs[0] == outputs[1] == []
