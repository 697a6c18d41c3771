"""What a parameter or an influence stands for, in words."""
import re

from language import Language


def meaning(name: str, t: Language) -> str:
    """Empty where only the name is known. "theta_3" is told by the words of "theta_#"."""
    words = t.named("result.meaning", name)
    if words != name:
        return words
    numbered = re.sub(r"\d+$", "#", name)
    words = t.named("result.meaning", numbered)
    return "" if words == numbered else words.replace("#", re.sub(r"\D*", "", name))
