import pytest
import warm


@pytest.fixture(scope="session", autouse=True)
def warmed():
    """Everything is imported before the first fork, so that a case costs milliseconds."""
    warm.up()
