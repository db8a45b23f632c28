# The suite and its demonstration (doc/docker.md):
#   docker build -t robomech_ros . && docker run --rm robomech_ros
FROM ubuntu:24.04

RUN apt-get update \
    && apt-get install -y --no-install-recommends ca-certificates g++ make python3 python3-dev python3-venv \
    && rm -rf /var/lib/apt/lists/*

WORKDIR /robomech_ros
COPY . .
RUN make setup

# Another robot: docker run -e ROBOT=ur5e
ENV ROBOT=puma560
CMD ["make", "demo"]
