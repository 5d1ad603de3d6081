// The quality of drafts is adapted to the time that pictures take.
#include <pliant/view/draft_quality.h>

#include <catch2/catch.hpp>

namespace draft_quality_test {
using namespace pliant;
using Quality = WindowRenderer::Quality;

/// Adds pictures whose time is proportional to the number of samples. full: time of a picture with one sample
/// for each pixel, s. Returns the number of changes of the quality.
int draw(DraftQuality& draft, double full, int pictures) {
  int changes = 0;
  for (int i = 0; i < pictures; ++i) {
    const Quality before = draft.quality();
    const double samples = WindowRenderer::samples(before);
    draft.add(full * samples * samples);
    if (draft.quality() != before) ++changes;
  }
  return changes;
}

TEST_CASE("drafts have fewer samples on a slow machine, and all again on a fast one") {
  DraftQuality draft;
  CHECK(draft.quality() == Quality::draft);
  CHECK(draw(draft, 0.9 * DraftQuality::kLongest, 100) == 0);
  CHECK(draw(draft, 1.1 * DraftQuality::kLongest, 100) == 1);
  CHECK(draft.quality() == Quality::two_thirds_draft);
  CHECK(draw(draft, 3 * DraftQuality::kLongest, 100) == 1);
  CHECK(draft.quality() == Quality::half_draft);
  CHECK(draw(draft, 100 * DraftQuality::kLongest, 100) == 0);
  CHECK(draw(draft, 0.5 * DraftQuality::kLongest, 100) == 2);
  CHECK(draft.quality() == Quality::draft);
}

TEST_CASE("one slow picture does not change the quality of drafts") {
  DraftQuality draft;
  draw(draft, 0.5 * DraftQuality::kLongest, 20);
  draft.add(2 * DraftQuality::kLongest);
  CHECK(draft.quality() == Quality::draft);
}

TEST_CASE("the first picture does not change the quality of drafts") {
  DraftQuality draft;
  draft.add(10);
  CHECK(draw(draft, 0.5 * DraftQuality::kLongest, 30) == 0);
}

TEST_CASE("drafts do not lose samples if this saves little time") {
  DraftQuality draft;
  int lower = 0;
  const int pictures = 4 * DraftQuality::kPause;
  for (int i = 0; i < pictures; ++i) {
    const double samples = WindowRenderer::samples(draft.quality());
    draft.add(0.036 + 0.003 * samples * samples);  // mostly other work
    if (draft.quality() != Quality::draft) ++lower;
  }
  CHECK(lower > 0);  // the lower quality is tried from time to time
  CHECK(lower < 0.05 * pictures);
}

TEST_CASE("drafts get their samples back although a part of their time is other work") {
  DraftQuality draft;
  const auto add = [&](int pictures, double slower) {
    for (int i = 0; i < pictures; ++i) {
      const double samples = WindowRenderer::samples(draft.quality());
      draft.add(slower * (0.02 + 0.01 * samples * samples));
    }
  };
  add(60, 3);
  // The next quality has 1/4 sample for each pixel instead of 4/9. It would save 8 % of the time.
  CHECK(draft.quality() == Quality::two_thirds_draft);
  add(3 * DraftQuality::kPause, 1);
  CHECK(draft.quality() == Quality::draft);
}

}  // namespace draft_quality_test
