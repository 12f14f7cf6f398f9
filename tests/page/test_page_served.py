"""What is served is text where names stand: nothing in a site's name runs."""

from elbowroom.page.plan.opened import frame_of as plan_frame
from elbowroom.page.served import answers_of, frame_of
from elbowroom.page.words import LANGUAGES, words_of

NASTY = '"><script>window.hit=1</script><img src=x onerror=window.hit=1>{{title}}'


def test_a_name_with_html_in_it_is_text_in_every_language():
    for language in LANGUAGES:
        words = words_of(language)
        for page in (frame_of(words, NASTY), plan_frame(words, NASTY).decode()):
            assert "window.hit=1</script>" not in page and "<img src=x" not in page
            assert "&lt;script&gt;window.hit=1&lt;/script&gt;" in page


def test_all_that_the_page_needs_is_served_and_its_words_are_filled_in():
    answers = answers_of(words_of("de"), "room")
    page = answers["/"].content.decode()
    assert "{{" not in page and 'id="controls"' in page and 'id="token"' in page
    program = answers["/page.js"].content.decode()
    assert program.index("const Panel") < program.index("const Controls") < program.index("Controls.begin(")
    assert "{{" not in answers["/page.css"].content.decode()
