import shutil

import pytest


@pytest.fixture(autouse=True, scope="session")
def _kernel_cache(tmp_path_factory):
    """Keep the kernels of these tests out of the user's cache."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("VEHICLEDYN_CACHE", str(tmp_path_factory.mktemp("kernels")))
        yield


@pytest.fixture(scope="session")
def needs_compiler():
    if not any(shutil.which(name) for name in ("cc", "gcc", "clang")):
        pytest.skip("no C compiler on the path")


@pytest.fixture(params=["compiled", "interpreted"])
def backend(request):
    if request.param == "compiled":
        request.getfixturevalue("needs_compiler")
    return request.param
