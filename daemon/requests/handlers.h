#pragma once

/// The handlers, by theme; handlers.cc lists them by method name, but for the jobs: those
/// follow from the table of jobs.

#include "daemon/requests/service.h"

namespace regrasp {

/// Answers with what `make` returns, or the RpcException it throws, on the worker thread: for what
/// reads the disk. `make` shares nothing with the I/O thread.
Outcome Later(Service& service, std::function<Json()> make);

/// job_requests.cc: of a command that starts a job; null for others.
Handler FindJobHandler(std::string_view method);

namespace handlers {

// simulation.cc
Outcome NoiseGet(Service&, const Params&, Client&);
Outcome NoiseSet(Service&, const Params&, Client&);
Outcome Pause(Service&, const Params&, Client&);
Outcome Push(Service&, const Params&, Client&);
Outcome Reset(Service&, const Params&, Client&);
Outcome Resume(Service&, const Params&, Client&);
Outcome Step(Service&, const Params&, Client&);
Outcome Stop(Service&, const Params&, Client&);

// parameters.cc
Outcome ParamGet(Service&, const Params&, Client&);
Outcome ParamList(Service&, const Params&, Client&);
Outcome ParamLoad(Service&, const Params&, Client&);
Outcome ParamReset(Service&, const Params&, Client&);
Outcome ParamSet(Service&, const Params&, Client&);

// inspect.cc
Outcome Contacts(Service&, const Params&, Client&);
Outcome Describe(Service&, const Params&, Client&);
Outcome Events(Service&, const Params&, Client&);
Outcome Hello(Service&, const Params&, Client&);
Outcome Identity(Service&, const Params&, Client&);
Outcome Joints(Service&, const Params&, Client&);
Outcome Quality(Service&, const Params&, Client&);
Outcome Shutdown(Service&, const Params&, Client&);
Outcome Status(Service&, const Params&, Client&);
Outcome Subscribe(Service&, const Params&, Client&);
Outcome Truth(Service&, const Params&, Client&);
Outcome Unsubscribe(Service&, const Params&, Client&);
Outcome VersionOf(Service&, const Params&, Client&);

// job_handlers.cc
Outcome JobCancel(Service&, const Params&, Client&);
Outcome JobGet(Service&, const Params&, Client&);
Outcome JobList(Service&, const Params&, Client&);
Outcome JobWait(Service&, const Params&, Client&);

// checkpoints.cc
Outcome CheckpointList(Service&, const Params&, Client&);
Outcome CheckpointRestore(Service&, const Params&, Client&);
Outcome CheckpointSave(Service&, const Params&, Client&);

// recordings.cc
Outcome RecordList(Service&, const Params&, Client&);
Outcome RecordStart(Service&, const Params&, Client&);
Outcome RecordStop(Service&, const Params&, Client&);

// results.cc
Outcome Plot(Service&, const Params&, Client&);

// shape.cc
Outcome Shape(Service&, const Params&, Client&);

}  // namespace handlers
}  // namespace regrasp
