"""What a parameter stands for, in words."""
import re

from language import Language


def meaning(name: str, t: Language) -> str:
    """Empty where only the name is known. "theta_3" is told by the words of "theta_#"."""
    words = t.named("result.meaning", re.sub(r"\d+$", "#", name))
    return "" if words in (name, re.sub(r"\d+$", "#", name)) else words.replace("#", re.sub(r"\D*", "", name))
