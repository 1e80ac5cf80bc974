import pytest


@pytest.fixture(autouse=True, scope="session")
def _kernel_cache(tmp_path_factory):
    """Keep the kernels of these tests out of the user's cache."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("VEHICLEDYN_CACHE", str(tmp_path_factory.mktemp("kernels")))
        yield
