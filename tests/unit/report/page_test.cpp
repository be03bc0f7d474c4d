#include "runtime/report/page.hpp"

#include "base/error.hpp"
#include "runtime/report/page_data.hpp"
#include "tests/unit/report/made_up_run.hpp"
#include "tests/unit/report/test_folder.hpp"

namespace brace {
namespace {

class Page : public TestFolder {
 protected:
  ReportInput input_of(const MadeUpRun& run) {
    ReportInput input = made_up_input();
    input.series.resize(1);
    input.series[0].records = run.records;
    input.series[0].jobs = run.jobs;
    return input;
  }
};

TEST_F(Page, IsOneFileWithNothingLeftToFillInOrToFetch) {
  const MadeUpRun run = made_up_run({.vsyncs = 50});
  write_page(folder_ / "report.html", input_of(run), BRACE_PAGE_FOLDER, folder_);
  const std::string page = text_of(folder_ / "report.html");
  EXPECT_EQ(page.find("{{style}}"), std::string::npos);
  EXPECT_EQ(page.find("{{data}}"), std::string::npos);
  for (const char* link : {"src=\"http", "href=\"http", "url(http", "@import", "fetch("}) {
    EXPECT_EQ(page.find(link), std::string::npos) << link;
  }
  EXPECT_NE(page.find("default-src 'none'"), std::string::npos);
  EXPECT_NE(page.find("Chart.js v3"), std::string::npos);
}

TEST_F(Page, TextOfASessionCannotEndTheScript) {
  const MadeUpRun run = made_up_run({.vsyncs = 5});
  ReportInput input = input_of(run);
  input.session_toml = "# </script><script>alert(1)</script> <!-- \xff {{style}}";
  write_page(folder_ / "report.html", input, BRACE_PAGE_FOLDER, folder_);
  const std::string page = text_of(folder_ / "report.html");
  EXPECT_EQ(page.find("alert(1)</script>"), std::string::npos);
  EXPECT_NE(page.find("\\u003c/script>\\u003cscript>alert(1)"), std::string::npos);
}

TEST_F(Page, SizeDoesNotGrowWithTheRun) {
  const MadeUpRun run = made_up_run({.vsyncs = 40'000}), longer = made_up_run({.vsyncs = 80'000});
  const std::size_t a = page_data(input_of(run), folder_).dump().size();
  const std::size_t b = page_data(input_of(longer), folder_).dump().size();
  EXPECT_LT(b, a + a / 5);
}

TEST_F(Page, TimelineOfALongRunHoldsTheLongestStaleRun) {
  MadeUpRun run = made_up_run({.vsyncs = 20'000});
  run.records[15'000].stale_run = 99;
  const Json timeline = page_data(input_of(run), folder_)["series"][0]["timeline"];
  ASSERT_EQ(timeline["vsyncs"].size(), page_timeline_vsyncs);
  EXPECT_LT(timeline["vsyncs"].front()[0], 15'000);
  EXPECT_GT(timeline["vsyncs"].back()[0], 15'000);
}

TEST_F(Page, PicturesAreEmbeddedFirstAndLastAmongThem) {
  const MadeUpRun run = made_up_run({.vsyncs = 100});
  ReportInput input = input_of(run);
  put(folder_ / "eye.png", "foobar");
  for (int k = 0; k < 100; ++k)
    input.series[0].pictures.push_back({k, "eye.png", "eye.png"});
  const Json series = page_data(input, folder_)["series"][0];
  ASSERT_EQ(series["pictures"].size(), page_picture_vsyncs);
  EXPECT_EQ(series["pictures"].front()["vsync"], 0);
  EXPECT_EQ(series["pictures"].back()["vsync"], 99);
  EXPECT_EQ(series["pictures"][3]["left"], "data:image/png;base64,Zm9vYmFy");
  EXPECT_EQ(series["pictures_total"], 100);
}

TEST_F(Page, MissingTemplateOrPictureIsNamed) {
  const MadeUpRun run = made_up_run({.vsyncs = 5});
  ReportInput input = input_of(run);
  const auto message = [&](const std::filesystem::path& template_folder) -> std::string {
    try {
      write_page(folder_ / "report.html", input, template_folder, folder_);
    } catch (const Error& e) {
      return e.what();
    }
    return "no error";
  };
  EXPECT_NE(message(folder_ / "nowhere").find("nowhere/report.css: cannot be read"), std::string::npos);
  input.series[0].pictures = {{0, "absent.png", "absent.png"}};
  EXPECT_NE(message(BRACE_PAGE_FOLDER).find("absent.png: cannot be read"), std::string::npos);
}

}  // namespace
}  // namespace brace
