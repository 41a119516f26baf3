from api.cli.exit_codes import INTERRUPTED, MISUSED, TABLE
from api.client.outcomes import Outcome


def test_the_table_has_each_code_once() -> None:
    codes = [line.split()[0] for line in TABLE.splitlines()[1:] if not line.startswith("   " * 2)]
    assert codes == [str(int(code)) for code in (*Outcome, MISUSED, INTERRUPTED)]
