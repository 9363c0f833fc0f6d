"""include/joulepath/tables.h declares what src/tables/ holds."""
import pytest
from tools.common import ToolError
from tools.design import tables_header


def test_the_committed_header_is_what_the_tool_writes():
    assert tables_header.HEADER.read_text("utf-8") == tables_header.render(
        tables_header.definitions(tables_header.TABLES))


def test_every_table_is_declared_with_its_type(tmp_path):
    (tmp_path / "b.c").write_text("const struct jp_two jp_two_b = {\n    1,\n};\n")
    (tmp_path / "a.c").write_text("static const int x[] = {1};\n\nconst struct jp_one jp_one_a = {\n    x,\n};\n")
    text = tables_header.render(tables_header.definitions(tmp_path))
    assert "struct jp_one;\nstruct jp_two;\n" in text
    assert text.index("extern const struct jp_one jp_one_a;") < text.index("extern const struct jp_two jp_two_b;")


def test_a_file_without_a_table_is_refused(tmp_path):
    (tmp_path / "empty.c").write_text("int x;\n")
    with pytest.raises(ToolError, match="empty.c: defines 0 tables"):
        tables_header.definitions(tmp_path)
