import pytest
from small_study import written


@pytest.fixture
def study(tmp_path):
    return written(tmp_path)
