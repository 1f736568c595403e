// Server-sent events: of one job, with replay; of all jobs, by state.
#include <charconv>

#include "server/http/api_parts.h"

namespace sheetform::server {
namespace {

constexpr auto kTurn = std::chrono::seconds(1);  // how soon a stream notices that the server stops
constexpr auto kPing = std::chrono::seconds(15);
constexpr auto kLongest = std::chrono::hours(1);
constexpr int kSnapshot = 100;

/// One message; `id` none for those that are not kept.
std::string event_text(const std::string& name, const std::string& data,
                       std::optional<std::int64_t> id = std::nullopt) {
  std::string text = id ? "id: " + std::to_string(*id) + "\n" : std::string();
  return text + "event: " + name + "\ndata: " + data + "\n\n";
}

Answer stream_answer(std::shared_ptr<LiveContent> content) {
  Answer answer;
  answer.media_type = "text/event-stream";
  answer.live = std::move(content);
  answer.with("Cache-Control", "no-store").with("X-Accel-Buffering", "no");
  return answer;
}

/// What every stream does: a place among those allowed, pings, an end after an hour or when the server stops.
class Stream {
 public:
  explicit Stream(ApiParts& parts)
      : parts_(parts), place_(parts.streams, parts.service.limits().event_streams, "event streams") {}

 protected:
  /// False when the stream is over; writes what is due to any stream.
  bool keep_up(const LiveContent::Write& write) {
    const auto now = SteadyClock::now();
    if (parts_.service.draining()) {
      write("event: shutdown\ndata: {}\n\n");
      return false;
    }
    if (now - begun_ > kLongest) return false;
    if (now - last_ping_ < kPing) return true;
    last_ping_ = now;
    return write(": ping\n\n");
  }

  ApiParts& parts_;

 private:
  CountedPlace place_;
  SteadyClock::time_point begun_ = SteadyClock::now(), last_ping_ = begun_;
};

class JobStream : public Stream {
 public:
  JobStream(ApiParts& parts, JobRecord job, std::int64_t last)
      : Stream(parts), job_(std::move(job)), last_(last), seen_(parts.service.bus().newest()) {}

  bool step(const LiveContent::Write& write) {
    if (!begun_) {
      begun_ = true;
      if (!write("retry: 3000\n\n")) return false;
    }
    if (!send_news(write)) return false;
    parts_.service.bus().wait(job_.id, seen_, SteadyClock::now() + kTurn);
    return keep_up(write);
  }

 private:
  /// Kept events that came since, then live progress; false after the last event of a finished job.
  bool send_news(const LiveContent::Write& write) {
    const std::optional<JobRecord> now = parts_.service.store().find(job_.id);
    if (!now) return false;
    job_ = *now;
    bool sent = false;
    for (const JobEvent& e : parts_.service.store().events_after(job_.seq, last_)) {
      if (!write(
              event_text("status", api::status_text(parts_.service.status_at(job_, e), kApiRoot), e.number)))
        return false;
      last_ = e.number;
      sent = true;
    }
    if (api::is_terminal(job_.state) && last_ >= job_.last_event) return false;
    return sent || send_live(write);
  }
  bool send_live(const LiveContent::Write& write) {
    const std::optional<LiveProgress> live = parts_.service.bus().live(job_.id);
    if (!live || (live->percent == percent_ && live->message == message_)) return true;
    percent_ = live->percent;
    message_ = live->message;
    return write(event_text("status", job_text(parts_, job_)));
  }

  JobRecord job_;
  std::int64_t last_;
  std::uint64_t seen_;
  bool begun_ = false;
  int percent_ = -1;
  std::string message_;
};

class ListStream : public Stream {
 public:
  ListStream(ApiParts& parts, std::optional<std::int64_t> visible)
      : Stream(parts), visible_(visible), sent_(parts.service.bus().newest()) {}

  bool step(const LiveContent::Write& write) {
    if (!begun_) {
      begun_ = true;
      if (!write("retry: 3000\n\n") || !send_snapshot(write)) return false;
    }
    std::uint64_t seen = sent_;
    parts_.service.bus().wait("", seen, SteadyClock::now() + kTurn);
    if (!send_changes(write)) return false;
    return keep_up(write);
  }

 private:
  bool send_snapshot(const LiveContent::Write& write) {
    sent_ = parts_.service.bus().newest();
    JobFilter filter;
    filter.principal = visible_;
    filter.limit = kSnapshot;
    std::vector<JobRecord> jobs = parts_.service.store().list(filter);
    if (static_cast<int>(jobs.size()) == kSnapshot) {  // what runs is told however old it is
      filter.after = {jobs.back().created, jobs.back().id};
      filter.states = {JobState::kRunning};
      const std::vector<JobRecord> running = parts_.service.store().list(filter);
      jobs.insert(jobs.end(), running.begin(), running.end());
    }
    return write(event_text("snapshot", "{\"jobs\":" + jobs_text(parts_, jobs) + "}"));
  }
  bool send_changes(const LiveContent::Write& write) {
    const std::uint64_t newest = parts_.service.bus().newest();
    const std::optional<std::vector<JobChange>> changed = parts_.service.bus().changed_since(sent_);
    if (!changed) return send_snapshot(write);
    sent_ = newest;
    for (const JobChange& change : *changed)
      if (!send_change(change, write)) return false;
    return true;
  }
  /// Nothing, not even an id, is told of the jobs of others.
  bool send_change(const JobChange& change, const LiveContent::Write& write) {
    const std::optional<JobRecord> job = parts_.service.store().find(change.job);
    const std::optional<std::int64_t> owner = job ? job->principal : change.removed_of;
    if (!owner || (visible_ && *owner != *visible_)) return true;
    if (job) return write(event_text("job", job_text(parts_, *job)));
    return write(event_text("removed", api::dump(api::Json{{"jobID", change.job}})));
  }

  std::optional<std::int64_t> visible_;
  std::uint64_t sent_;
  bool begun_ = false;
};

template <class S>
Answer answer_with(std::shared_ptr<S> stream) {
  auto content = std::make_shared<LiveContent>();
  content->step = [stream](const LiveContent::Write& write) { return stream->step(write); };
  return stream_answer(std::move(content));
}

/// Number of the last event that a client has seen; 0 when it says nothing usable.
std::int64_t last_event_id(const Exchange& x) {
  const std::string text = x.head.field("last-event-id");
  std::int64_t number = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  return error == std::errc() && end == text.data() + text.size() && number > 0 ? number : 0;
}

Answer job_events(Exchange& x, ApiParts& parts) {
  const JobRecord job = parts.service.job(x.captures.at(0), x.visible());
  const std::int64_t last = last_event_id(x);
  if (api::is_terminal(job.state) && last >= job.last_event) {
    Answer answer;
    answer.status = 204;  // tells an EventSource not to come back
    return answer;
  }
  return answer_with(std::make_shared<JobStream>(parts, job, last));
}

}  // namespace

void add_event_routes(Router& router, ApiParts& parts) {
  const std::string root = kApiRoot;
  router.add(
      {"GET", root + "/jobs/{jobID}/events", "read", [&parts](Exchange& x) { return job_events(x, parts); }});
  router.add({"GET", root + "/events", "read", [&parts](Exchange& x) {
                return answer_with(std::make_shared<ListStream>(parts, x.visible()));
              }});
}

}  // namespace sheetform::server
