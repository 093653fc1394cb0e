"""Elements of a page, and a rotation whose words hold markup."""

from __future__ import annotations

from html.parser import HTMLParser

import rigidsym as rs
from rigidsym.models.rotation import Citation, elementary, time_function

ODD = "</title></script><script>document.title='owned'</script><img src=x onerror=alert(1)> & \"'"


def odd_model() -> rs.RotationModel:
    """A rotation whose words hold markup."""
    a, b = time_function("a"), time_function("b")
    return rs.RotationModel(
        name="odd",
        title=ODD,
        convention=(ODD,),
        coordinates=(a, b),
        matrix=elementary("z", a) * elementary("x", b),
        source=Citation(text=ODD, equation=ODD),
    )


class Elements(HTMLParser):
    """Tags with their attributes, in order, and the text of each heading."""

    def __init__(self, text: str) -> None:
        super().__init__()
        self.tags: list[tuple[str, dict[str, str | None]]] = []
        self.feed(text)

    def handle_starttag(self, tag, attrs):
        self.tags.append((tag, dict(attrs)))

    def named(self, *names: str) -> list[dict[str, str | None]]:
        return [attributes for tag, attributes in self.tags if tag in names]
