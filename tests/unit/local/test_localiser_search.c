/* Which places a search keeps, and what it finds in the end. */
#include "src/local/localiser_search.h"

#include "tests/support/near.h"

static struct jp_localiser_search search;

void setUp(void)
{
    search.places[0].score = 0.0f;
    search.places[1].score = 0.0f;
    search.places[0].pose.x = -10.0f;
}

void tearDown(void)
{
}

static void keep(float x, float heading, float score)
{
    const struct jp_localiser_place place = {{x, 1.0f, heading}, score};

    jp_localiser_search_keep(&search, &place);
}

static void expect(float first, float second)
{
    TEST_ASSERT_NEAR(1.0e-6f, first, search.places[0].score);
    TEST_ASSERT_NEAR(1.0e-6f, second, search.places[1].score);
}

static void test_the_best_and_the_best_apart_from_it_are_kept(void)
{
    TEST_ASSERT_EQUAL_INT(JP_LOCALISER_NO_PLACE, jp_localiser_search_finding(&search));
    keep(2.0f, 0.0f, 0.8f);
    expect(0.8f, 0.0f);
    TEST_ASSERT_EQUAL_INT(JP_LOCALISER_ONE_PLACE, jp_localiser_search_finding(&search));
    keep(2.3f, 0.0f, 0.85f);
    expect(0.85f, 0.0f);
    keep(2.4f, 0.2f, 0.82f);
    expect(0.85f, 0.0f);
    keep(5.0f, 0.0f, 0.7f);
    expect(0.85f, 0.7f);
    keep(2.3f, 1.0f, 0.8f);
    expect(0.85f, 0.8f);
    keep(8.0f, 0.0f, 0.75f);
    expect(0.85f, 0.8f);
    TEST_ASSERT_EQUAL_INT(JP_LOCALISER_MANY_PLACES, jp_localiser_search_finding(&search));
    keep(8.0f, 0.0f, 0.99f);
    expect(0.99f, 0.85f);
    TEST_ASSERT_EQUAL_INT(JP_LOCALISER_ONE_PLACE, jp_localiser_search_finding(&search));
}
