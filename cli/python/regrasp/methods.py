"""The methods of the daemon. Made by make_methods.py from the method table; change that, not this file."""

from .connection import Job


class Methods:
    """Every method of the daemon; arguments left out (None) are not sent."""

    def _ask(self, method, params):
        return self.call(method, **{name: value for name, value in params.items() if value is not None})

    def _job(self, method, params):
        return Job(self, self._ask(method, params)["job"])

    def checkpoint_list(self) -> dict:
        """The checkpoints in the output directory.
        Returns checkpoints: [{name, tick, time_s, state, state_hash, seed, object, commands, same_build}].
        """
        return self._ask("checkpoint.list", {})

    def checkpoint_restore(self, name: str, seed: int | None = None, reexecute: bool | None = None) -> Job:
        """Go on from a checkpoint: identically, or with another seed.
        name: letters, digits, - _ . ; at most 64, neither . nor - first.
        seed: branch: sensor noise and later random choices follow this seed; 0 to 2**53; left out: go on
            identically.
        reexecute: execute the commands again from tick 0, rather than load the state; left out: false.
        Returns a Job.
        """
        return self._job("checkpoint.restore", {"name": name, "seed": seed, "reexecute": reexecute})

    def checkpoint_save(self, name: str) -> dict:
        """Keep this moment, to go on from it later; one of this name is replaced.
        name: letters, digits, - _ . ; at most 64, neither . nor - first.
        Returns name, tick, time_s, state, state_hash, commands, path, replaced: whether there was one of this name.
        """
        return self._ask("checkpoint.save", {"name": name})

    def contacts(self) -> dict:
        """What the controller senses at each fingertip.
        Returns tick, time_s, object: {p_WO_m, q_WO_wxyz, p_WO_reference_m (where control wants it)}, normals:
            outward (out of the object), friction, weight_n, max_force_n (what the controller reckons with),
            fingers: {NAME: {role, in_contact, p_WC_m, normal_W, force_n, force_command_W_n}}; p_WC_m and normal_W
            are null without contact, p_WO_reference_m until the hand alone holds the object; evaluate takes this
            answer as it is.
        """
        return self._ask("contacts", {})

    def describe(self, method: str | None = None) -> dict:
        """Every method with its parameters, types, units and ranges.
        method: only this method; left out: all methods.
        Returns version, protocol, methods, errors.
        """
        return self._ask("describe", {"method": method})

    def events(self, count: int | None = None) -> dict:
        """The latest events.
        count: at most so many, the newest; 1 to 1000; left out: 100.
        Returns events: [{tick, t_s, kind, finger, text, ...}], oldest first; dropped.
        """
        return self._ask("events", {"count": count})

    def explore(self, finger: str, criterion: str | None = None, estimator: str | None = None, seed: int | None = None, max_cycles: int | None = None) -> Job:
        """Improve the grasp by sliding one finger over the surface.
        finger: the finger that explores; one of first, middle, ring, little, thumb.
        criterion: what it maximises; one of manipulability, stability, switched, combined, reserve; left out:
            manipulability.
        estimator: how it estimates the gradient; secant is the rule as printed; one of least_squares, secant; left
            out: least_squares.
        seed: seed of the random start direction; 0 to 2**53; left out: the seed of the run.
        max_cycles: give up after so many cycles; 1 to 1000000; left out: parameter exploration.max_cycles.
        Returns a Job.
        """
        return self._job("explore", {"finger": finger, "criterion": criterion, "estimator": estimator, "seed": seed, "max_cycles": max_cycles})

    def grasp(self) -> Job:
        """Close the hand on the object and hold it.
        Returns a Job.
        """
        return self._job("grasp", {})

    def identity(self) -> dict:
        """What decides the results, besides seed and commands: equal answers, equal bits.
        Returns build; stepper; models: {scenario, hand, object}, each {name, hash of the model as it was read};
            parameters: {NAME: value} of those that differ from their defaults.
        """
        return self._ask("identity", {})

    def job_cancel(self, id: int) -> dict:
        """End a job.
        id: number of the job; 1 to 2**53.
        Returns the record of the job.
        """
        return self._ask("job.cancel", {"id": id})

    def job_get(self, id: int) -> dict:
        """The record of a job.
        id: number of the job; 1 to 2**53.
        Returns the record of the job.
        """
        return self._ask("job.get", {"id": id})

    def job_list(self) -> dict:
        """The last 256 jobs, oldest first.
        Returns jobs: [record].
        """
        return self._ask("job.list", {})

    def job_wait(self, id: int, timeout_s: float | None = None) -> dict:
        """Wait until a job has ended; the only deferred answer.
        id: number of the job; 1 to 2**53.
        timeout_s: answer with error -32004 after so long (wall clock) [s]; 0 to 1000000; left out: no limit.
        Returns the record of the job.
        """
        return self._ask("job.wait", {"id": id, "timeout_s": timeout_s})

    def joints(self) -> dict:
        """Joint angles, torques and limits.
        Returns tick, time_s, joints: [{name, finger, angle_rad, torque_nm, lower_rad, upper_rad}].
        """
        return self._ask("joints", {})

    def move(self, offset_m: list[float] | None = None, rotation_rad: list[float] | None = None) -> Job:
        """Move the object a little with all fingers, without a regrasp.
        offset_m: shift of the object's centre, in W; its length is at most 0.05 m [m]; -0.05 to 0.05; left out: [0,
            0, 0].
        rotation_rad: turn of the object, a rotation vector in W; its length is at most pi [rad]; -3.141592653589793
            to 3.141592653589793; left out: [0, 0, 0].
        Returns a Job.
        """
        return self._job("move", {"offset_m": offset_m, "rotation_rad": rotation_rad})

    def noise_get(self) -> dict:
        """Noise levels of the sensors.
        Returns preset and every level.
        """
        return self._ask("noise.get", {})

    def noise_set(self, preset: str | None = None, position_m: float | None = None, normal_rad: float | None = None, force_n: float | None = None, joint_rad: float | None = None, object_position_m: float | None = None, object_rotation_rad: float | None = None, position_bias_m: float | None = None, force_bias_n: float | None = None, joint_bias_rad: float | None = None, object_bias_m: float | None = None, position_drift_m: float | None = None, force_drift_n: float | None = None, object_drift_m: float | None = None, dropout_fraction: float | None = None, dropout_gap_s: float | None = None, latency_s: float | None = None, taxel_pitch_m: float | None = None, object_rate_hz: float | None = None, object_delay_frames: int | None = None) -> dict:
        """Change noise levels.
        preset: all levels of a preset; other parameters then change single levels; one of off, fine, paper, coarse,
            taxel; left out: the present levels.
        position_m: contact position, standard deviation per axis [m]; 0 to 0.1; left out: unchanged.
        normal_rad: contact normal, per tangent axis [rad]; 0 to 1.6; left out: unchanged.
        force_n: normal force [N]; 0 to 10; left out: unchanged.
        joint_rad: joint angle [rad]; 0 to 1.6; left out: unchanged.
        object_position_m: object position, per axis [m]; 0 to 0.1; left out: unchanged.
        object_rotation_rad: object orientation, per axis [rad]; 0 to 1.6; left out: unchanged.
        position_bias_m: contact position, constant, per axis of the fingertip [m]; 0 to 0.02; left out: unchanged.
        force_bias_n: normal force, constant [N]; 0 to 2; left out: unchanged.
        joint_bias_rad: joint angle, constant [rad]; 0 to 0.5; left out: unchanged.
        object_bias_m: object position, constant, per axis [m]; 0 to 0.05; left out: unchanged.
        position_drift_m: contact position, random walk, after one second [m]; 0 to 0.02; left out: unchanged.
        force_drift_n: normal force, random walk, after one second [N]; 0 to 2; left out: unchanged.
        object_drift_m: object position, random walk, after one second [m]; 0 to 0.05; left out: unchanged.
        dropout_fraction: share of the time in which a fingertip feels nothing; 0 to 0.9; left out: unchanged.
        dropout_gap_s: mean length of such a gap; 0: a sample, which is the least [s]; 0 to 1; left out: unchanged.
        latency_s: age of what a fingertip reports [s]; 0 to 0.02; left out: unchanged.
        taxel_pitch_m: contacts are felt by taxels this far apart; 0: without taxels, positions are continuous [m];
            0 to 0.05; left out: unchanged.
        object_rate_hz: the object's pose comes so often; 0: with every reading [Hz]; 0 to 1000; left out:
            unchanged.
        object_delay_frames: delay of the object's pose, in poses; only with object_rate_hz; 0 to 7; left out:
            unchanged.
        Returns preset and every level.
        """
        return self._ask("noise.set", {"preset": preset, "position_m": position_m, "normal_rad": normal_rad, "force_n": force_n, "joint_rad": joint_rad, "object_position_m": object_position_m, "object_rotation_rad": object_rotation_rad, "position_bias_m": position_bias_m, "force_bias_n": force_bias_n, "joint_bias_rad": joint_bias_rad, "object_bias_m": object_bias_m, "position_drift_m": position_drift_m, "force_drift_n": force_drift_n, "object_drift_m": object_drift_m, "dropout_fraction": dropout_fraction, "dropout_gap_s": dropout_gap_s, "latency_s": latency_s, "taxel_pitch_m": taxel_pitch_m, "object_rate_hz": object_rate_hz, "object_delay_frames": object_delay_frames})

    def param_get(self, name: str | None = None) -> dict:
        """Values, units, ranges and sources of parameters.
        name: the parameter; left out: all parameters.
        Returns name, value, default, changed, type, unit, min, max, words, size, description, source (of the
            value), default_source; without a name parameters: [...].
        """
        return self._ask("param.get", {"name": name})

    def param_list(self, group: str | None = None, changed: bool | None = None) -> dict:
        """Every parameter, a group, or what has been changed.
        group: only parameters whose names begin so: gait; one of control, exploration, gait, gravity, object,
            shape, start; left out: all.
        changed: only parameters that differ from their defaults; left out: false.
        Returns parameters: [{name, value, ... as param.get}].
        """
        return self._ask("param.list", {"group": group, "changed": changed})

    def param_load(self, parameters: dict) -> dict:
        """Set many parameters at once.
        parameters: values by name; all are set, or none where one is refused.
        Returns parameters: [{name, value, ... as param.get}] that were given; kept: {NAME: value} of the others
            that differ from their defaults.
        """
        return self._ask("param.load", {"parameters": parameters})

    def param_reset(self, name: str | None = None) -> dict:
        """Set parameters back to their defaults.
        name: the parameter, or the group: gait; left out: all parameters.
        Returns parameters: [{name, value, before, ...}] that were changed before.
        """
        return self._ask("param.reset", {"name": name})

    def param_set(self, name: str, value: object) -> dict:
        """Change a parameter.
        name: the parameter.
        value: its new value, of the type and in the range that param.get tells.
        Returns name, value, default, changed, type, unit, min, max, words, size, description, source,
            default_source.
        """
        return self._ask("param.set", {"name": name, "value": value})

    def pause(self) -> dict:
        """Stop the clock of the simulation; a step that runs ends.
        Returns paused, tick, clock (continuous, lockstep).
        """
        return self._ask("pause", {})

    def plot(self, name: str, file: str | None = None, overwrite: bool | None = None, last_s: float | None = None, size_m: float | None = None, title: bool | None = None, font_size_pt: float | None = None, dpi: float | None = None) -> dict:
        """Draw a picture into the output directory.
        name: the picture; one of comparison, contacts, gait, incident, quality, scene, shape.
        file: file name (not a path), written in the daemon's output directory; its suffix decides: .png, .jpg,
            .pdf, .svg; left out: NAME.png, or NAME-2.png ... where that is there.
        overwrite: replace a picture of this name; otherwise that is an error; left out: false.
        last_s: only the last so many seconds [s]; 0.1 to 600; left out: everything kept.
        size_m: printed width, of text of at least 7 pt [m]; 0.05 to 1; left out: for a screen.
        title: the picture's title and its line of facts; left out: true.
        font_size_pt: with size: no text on paper is smaller [pt]; 4 to 24; left out: 7.
        dpi: with size: pixels per inch of a .png or .jpg; 50 to 1200; left out: 1600 pixels wide.
        Returns file (name), path, bytes, tick.
        """
        return self._ask("plot", {"name": name, "file": file, "overwrite": overwrite, "last_s": last_s, "size_m": size_m, "title": title, "font_size_pt": font_size_pt, "dpi": dpi})

    def push(self, force_n: list[float], duration_s: float | None = None) -> dict:
        """Push the object: a disturbance.
        force_n: force at the object's centre, in W [N]; -100 to 100.
        duration_s: how long it acts [s]; 0.001 to 60; left out: 0.1.
        Returns force_n, duration_s.
        """
        return self._ask("push", {"force_n": force_n, "duration_s": duration_s})

    def quality(self, measures: str | None = None) -> dict:
        """Quality of the grasp.
        measures: all, or frame: only those that every frame has, for who asks often; one of all, frame; left out:
            all.
        Returns tick, time_s, criterion, stability, stability_measure, threshold, load_margin_n, measures: [NAME]
            and the value of each by its name, torque_scale_m (mean distance of the contacts from the object's
            centre; torques are divided by it), fingers: {NAME: {manipulability, load_margin_without_n,
            joint_limit_margin_rad}}, exploration (null, or of the one that runs: finger, criterion, cycle, phi,
            gradient_norm_1_m, gradient_threshold_1_m); measures and margins are null while no finger that holds is
            in contact.
        """
        return self._ask("quality", {"measures": measures})

    def record_list(self) -> dict:
        """The run files in the output directory.
        Returns recordings: [{file, bytes, complete, recording}].
        """
        return self._ask("record.list", {})

    def record_start(self, file: str | None = None, rate_hz: float | None = None) -> dict:
        """Write the run into a file, from its beginning; it can be replayed.
        file: file name (not a path), written in the daemon's output directory; left out: run-001.mcap, or the next
            number.
        rate_hz: samples per second of simulated time; commands, events and state hashes are always complete [Hz];
            0.1 to 100; left out: 25.
        Returns file, path, rate_hz, tick, commands (so far).
        """
        return self._ask("record.start", {"file": file, "rate_hz": rate_hz})

    def record_stop(self) -> dict:
        """End the run file.
        Returns file, path, messages, bytes, dropped.
        """
        return self._ask("record.stop", {})

    def release(self) -> Job:
        """Open the hand.
        Returns a Job.
        """
        return self._job("release", {})

    def reset(self, seed: int | None = None, object: str | None = None) -> dict:
        """Start a new run; parameters and noise levels stay.
        seed: seed of the new run; 0 to 2**53; left out: the present seed.
        object: another object, by name; left out: the present object.
        Returns seed, object, changed_parameters: {NAME: value} that stay, warnings [] (why this object cannot be
            grasped where it begins).
        """
        return self._ask("reset", {"seed": seed, "object": object})

    def resume(self) -> dict:
        """Let the clock of the simulation run again.
        Returns paused, tick, clock.
        """
        return self._ask("resume", {})

    def rotate(self, angle_rad: float | None = None, turns: float | None = None, continuous: bool | None = None, axis: list[float] | None = None, speed_rad_s: float | None = None) -> Job:
        """Turn the object in the hand by finger gaiting.
        angle_rad: turn by this angle, signed; or give turns or continuous [rad]; -10000 to 10000; left out: not
            used.
        turns: turn so many times, signed; -1000 to 1000; left out: not used.
        continuous: turn until stopped; left out: false.
        axis: direction in W about which the object turns; any length but zero; -1000000 to 1000000; left out: [0,
            0, 1].
        speed_rad_s: speed of the object while it moves [rad/s]; 0.001 to 10; left out: parameter gait.speed_rad_s.
        Returns a Job.
        """
        return self._job("rotate", {"angle_rad": angle_rad, "turns": turns, "continuous": continuous, "axis": axis, "speed_rad_s": speed_rad_s})

    def shape(self, mesh: bool | None = None) -> dict:
        """The object's surface as the fingers have felt it.
        mesh: also the surface as a closed mesh, in the object's frame; left out: false.
        Returns tick, time_s, object, touched_fraction (of all directions), touched_cells, cells, mean_radius_m,
            truth (for judging; null before anything was felt well: cells, rms_error_m, mean_error_m (bias, positive
            outside), normal_error_rad (median)), mesh: {vertices_O_m, normals_O, unknown_rad (angle to the nearest
            felt direction), error_m (to the true surface), triangles}.
        """
        return self._ask("shape", {"mesh": mesh})

    def shutdown(self) -> dict:
        """Stop the daemon cleanly.
        Returns stopping, activated (true: the service manager starts another at the next connection).
        """
        return self._ask("shutdown", {})

    def status(self) -> dict:
        """State of daemon and simulation.
        Returns version, protocol, state, paused, clock (continuous, lockstep), advancing (time goes on now), tick,
            time_s, state_hash, real_time_factor (0 while time stands still, null where it is not known yet), speed,
            stepper, stepper_reason, tick_p99_s, seed, hand, object, warnings, job, gait: {active, phase, finger,
            state, reference_angle_rad, target_angle_rad (equal to it, kept for scripts), achieved_angle_rad,
            cycles, regrasps}, incident (the last drop: tick, cause, record, picture; or null), noise, clients, ....
        """
        return self._ask("status", {})

    def step(self, ticks: int | None = None, until_job_ends: bool | None = None) -> Job:
        """Advance a simulation that is paused, or stands still in lockstep.
        ticks: how many ticks; 1 to 1000000000; left out: 1.
        until_job_ends: no further than to the end of the job that is running or waits to begin; left out: false.
        Returns a Job.
        """
        return self._job("step", {"ticks": ticks, "until_job_ends": until_job_ends})

    def stop(self) -> dict:
        """End the current job, or step, and keep holding.
        Returns job (the one that ends), or null; step (the job of the step that ends), or null; begun (false: the
            job ended before it began; null without a job).
        """
        return self._ask("stop", {})

    def truth(self) -> dict:
        """What only the simulator knows.
        Returns tick, time_s, object {p_WO_m, q_WO_wxyz, v_m_s, w_rad_s, mass_kg, friction}, contacts [{link,
            finger, p_WC_m, normal_W, force_W_n, depth_m}], fingers: {NAME: {in_contact, manipulability, p_WC_m,
            p_WF_m (of the fingertip)}}, gravity_W_m_s2, stand_in (it holds the object before the fingers do).
        """
        return self._ask("truth", {})

    def version(self) -> dict:
        """Version of the daemon.
        Returns version, protocol.
        """
        return self._ask("version", {})
