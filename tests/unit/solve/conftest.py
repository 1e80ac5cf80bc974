import pytest

from vehicledyn.solve.compiler import suitable_lanes


@pytest.fixture(autouse=True, scope="session")
def _kernel_cache(tmp_path_factory):
    """Keep the kernels of these tests out of the user's cache."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("VEHICLEDYN_CACHE", str(tmp_path_factory.mktemp("kernels")))
        yield


@pytest.fixture(params=["compiled", "interpreted"])
def backend(request):
    if request.param == "compiled":
        request.getfixturevalue("needs_compiler")
    return request.param


@pytest.fixture(params=[4, 8])
def lanes(request, needs_compiler):
    if request.param > suitable_lanes():
        pytest.skip(f"this processor carries no {request.param} lanes")
    return request.param
