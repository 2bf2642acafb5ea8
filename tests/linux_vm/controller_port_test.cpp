// tactree-controller at counters and converters, and at a USB device port.

#include "controller_rig.hpp"
#include "tactree/client/usb_devices.hpp"
#include "tactree/client/usb_transport.hpp"

namespace tactree::vm_test {
namespace {

/// Encoders at counters, motors at converters; homed in a given pose.
class AnalogueController : public Controller {
 protected:
  AnalogueController() : Controller(true) {}

  void SetUp() override {
    Controller::SetUp();
    write_device("given-pose");
    const auto axis = [](int i) {
      return json{{"converter", kConverterDevice},
                  {"channel", i},
                  {"zero_code", kZeroCode},
                  {"full_code", kFullCode},
                  {"effort_at_full", kFullEffort_N}};
    };
    const auto counter = [](int i) { return json{{"counter", kCounterDevice}, {"count", i}}; };
    file_["encoders"] = {{"counter_root", analogue_->root().string()},
                         {"axes", axes({counter(0), counter(1), counter(2)})}};
    file_["motors"] = {{"converter_root", analogue_->root().string()},
                       {"good", "good"},
                       {"axes", axes({axis(0), axis(1), axis(2)})}};
  }

  void find_home() override {
    device_->move_hand({0.0, 0.0, 0.0}, 0.2);
    std::this_thread::sleep_for(500ms);
    board_->home();
  }
};

TEST_F(AnalogueController, HomesArmsRendersAndStops) {
  EXPECT_EQ(run({"--dry-run"}), 0) << output();
  EXPECT_TRUE(holds(output(), "encoders at counters")) << output();
  hold();
  ASSERT_FALSE(HasFatalFailure());
  std::this_thread::sleep_for(300ms);
  expect_balance(kRadius_m - 0.005);
  EXPECT_EQ(hands().edges, 0U);
  EXPECT_EQ(board_->state().state, kActive);
  EXPECT_NEAR(static_cast<double>(board_->state().probe_m[2]), hands().tip_m[2], 0.001);
  kill(child_, SIGTERM);
  EXPECT_EQ(finish(std::exchange(child_, -1)), 0) << output();
  EXPECT_FALSE(is_enabled());
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_EQ(analogue_->code(i), kZeroCode);
  }
  expect_undisturbed();
}

TEST_F(AnalogueController, NamesMistakesWithRemedy) {
  const auto refuses = [&](const std::string& part) {
    EXPECT_EQ(run(), 1) << part;
    EXPECT_TRUE(holds(output(), "error: ") && holds(output(), part)) << part << "\n" << output();
    EXPECT_FALSE(is_enabled());
  };
  const json good = file_;
  file_["encoders"]["axes"][1]["counter"] = "rest.counter";
  refuses("counter 'rest.counter': no such device in");
  file_ = good;
  file_["encoders"]["axes"][1]["count"] = 3;
  refuses("it has no count 3");
  file_ = good;
  file_["encoders"]["axes"][1] = {{"a", "enc1-a"}, {"b", "enc1-b"}};
  refuses("is given for some axes only");
  file_ = good;
  file_["motors"]["axes"][0]["converter"] = "rest.dac";
  refuses("converter 'rest.dac': no such device in");
  file_ = good;
  file_["motors"]["axes"][0]["channel"] = 3;
  refuses("it has no output 3");
  file_ = good;
  file_["motors"]["axes"][0]["zero_code"] = 100;
  refuses("leaves no range for efforts of the opposite sign");
  file_ = good;
  write_device("index");
  refuses("counters report no index pulse");
}

/// The link is the USB device port of this computer, which is also its USB host.
class UsbController : public Controller {
 protected:
  void SetUp() override {
    Controller::SetUp();
    file_.erase("socket");
    file_["usb"] = {{"port", "dummy_udc.0"}, {"serial", 77}};
  }
  void connect() override {
    std::string why;
    ASSERT_TRUE(eventually([&] {
      try {
        board_ = std::make_unique<client::Board>(client::open_usb(""),
                                                 client::BoardOptions{115200, 100});
      } catch (const std::runtime_error& error) {
        why = error.what();
      }
      return board_ != nullptr;
    })) << why;
  }
  static std::size_t gadgets() {
    const auto folder = fs::directory_iterator("/sys/kernel/config/usb_gadget");
    return static_cast<std::size_t>(std::distance(begin(folder), end(folder)));
  }
};

TEST_F(UsbController, HomesArmsRendersAndStops) {
  EXPECT_EQ(run({"--dry-run"}), 0) << output();
  EXPECT_TRUE(holds(output(), "dummy_udc.0")) << output();
  hold();
  ASSERT_FALSE(HasFatalFailure());
  EXPECT_EQ(client::list_usb_devices().at(0).serial, "00000000000000000000004D");
  std::this_thread::sleep_for(300ms);
  expect_balance(kRadius_m - 0.005);
  EXPECT_EQ(board_->state().state, kActive);
  board_->stop();
  EXPECT_TRUE(eventually([&] { return !is_enabled(); }));
  kill(child_, SIGTERM);
  EXPECT_EQ(finish(std::exchange(child_, -1)), 0) << output();
  expect_undisturbed();
  EXPECT_EQ(gadgets(), 0U) << "removed at the end";
}

TEST_F(UsbController, RemovesGadgetOfKilledProcess) {
  hold();
  ASSERT_FALSE(HasFatalFailure());
  kill(child_, SIGKILL);
  EXPECT_EQ(finish(std::exchange(child_, -1)), 1000 + SIGKILL);
  ASSERT_TRUE(eventually([&] { return !is_enabled(); }));
  EXPECT_EQ(gadgets(), 1U);
  board_.reset();
  hands().dead_man = false;
  serve();
  ASSERT_FALSE(HasFatalFailure());
  EXPECT_EQ(gadgets(), 1U) << "the gadget of the new process";
  EXPECT_EQ(board_->state().faults, 0U) << client::names_of(board_->state().faults);
}

TEST_F(UsbController, NamesMissingPort) {
  file_["usb"]["port"] = "none.0";
  EXPECT_EQ(run({"--dry-run"}), 1);
  EXPECT_TRUE(holds(output(), "no USB device port is 'none.0' (hint: name one of: dummy_udc.0"))
      << output();
  EXPECT_EQ(run(), 1);
  file_["socket"] = socket_;
  EXPECT_EQ(run(), 1);
  EXPECT_TRUE(holds(output(), "exactly one of socket and usb")) << output();
}

}  // namespace
}  // namespace tactree::vm_test
